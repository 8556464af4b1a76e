//! Whether what was found may be named.

use super::candidates::Candidate;
use super::outcome::{GapRow, Verdict};
use super::policy::POLICY;
use super::search::Search;
use super::search::node::{Node, at_floor};
use super::show::{Show, stages};
use crate::error::Result;
use crate::identify::State;
use crate::identify::robust::Crowd;

/// Explained or unexplained, and the explanation that may be named; one that
/// needs no name is clean. What may be named is decided by the `full`
/// explanation: how many terms the model may have is no reason to doubt them.
pub fn judge(search: &Search, root: &Node, full: &Node, best: &Node) -> Result<(Verdict, Node)> {
    if at_floor(best) {
        return Ok((Verdict::Explained, best.clone()));
    }
    // Rows that contradict each other are no ground for a name.
    if search.flags.crowd == Crowd::Described {
        return Ok((Verdict::Unexplained, root.clone()));
    }
    // Something is left. Names are given only to what carries a good part of
    // the structure, and only if together they carry nearly all of it.
    let excess = (root.reduced - 1.0).max(1e-9);
    let many = search.rows.len() >= POLICY.many_rows;
    let enough = if many { POLICY.nameable_many } else { POLICY.nameable_few };
    if 1.0 - (full.reduced - 1.0) / excess < enough {
        return Ok((Verdict::Unexplained, root.clone()));
    }
    let stages = stages(search, root, best)?;
    let strong = |k: &usize| (stages[*k - 1].reduced - stages[*k].reduced) / excess > POLICY.strong;
    let last = (1..stages.len()).take_while(strong).last().unwrap_or(0);
    Ok((Verdict::Unexplained, stages[last].clone()))
}

/// Drops effects that do not lower the error of held-out poses, as long as the
/// rest stays as good as it was.
pub fn with_held_out_gain(
    show: &Show,
    root: &Node,
    mut best: Node,
    nominal: &State,
) -> Result<(Node, Vec<Node>, Vec<GapRow>)> {
    loop {
        let stages = stages(show.search, root, &best)?;
        let gap = show.gap(nominal, &stages)?;
        let held = |k: usize| gap[k + 1].cross_validated_rms_mm.unwrap_or(f64::INFINITY);
        let useless = (1..stages.len()).rev().find(|k| held(*k) >= held(k - 1));
        let Some(k) = useless else { return Ok((best, stages, gap)) };
        let fresh = |c: &Candidate| {
            stages[k - 1].added.iter().any(|a| a.name() == c.name())
                || stages[k].added.iter().all(|a| a.name() != c.name())
        };
        let added = best.added.iter().filter(|c| fresh(c)).cloned().collect();
        let without = show.search.fit(added, &best.fit.fit.state)?;
        if at_floor(&without) != at_floor(&best) {
            return Ok((best, stages, gap));
        }
        best = without;
    }
}
