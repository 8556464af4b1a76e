//! On which side of its gap a joint rested before it first moved: where the order of the
//! rows tells the sides, nothing tells the first of a session, of a series, or behind rows that
//! are missing. In a session that moves one joint after another that are most of the rows of
//! the last one; where all joints move that is a row, which the whole gap may put beyond every
//! noise: it is no gross error.

mod gaps;
mod heads;

use truearm::effects::Effect;

use super::nameless;
use super::start::Bent;
use super::weighed::Weighed;
use crate::diagnose::node::Node;
use crate::diagnose::question::Question;
use crate::error::Result;
use crate::identify::fit::robust::{Flags, RobustFit, robust_fit};
use crate::identify::{Problem, State};
use crate::model::{ErrorCurve, Measurements, ModelTerm, Row};
use gaps::{Beside, Gaps};
use heads::{Head, heads, with};

/// The measurements with the first sides that are told beside geometry if every joint has a
/// gap; `None` where there is no row of unknown sides.
///
/// # Errors
/// When geometry cannot be fitted.
pub fn found(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    flags: Flags,
) -> Result<Option<Measurements>> {
    let heads = heads(problem.data);
    if heads.is_empty() {
        return Ok(None);
    }
    let fit = robust_fit(problem, rows, start, flags)?;
    let frictions = vec![0.0; problem.nominal.len()];
    let (state, lambda) = (&fit.fit.state, flags.lambda);
    let beside = Beside { problem, state, lambda, frictions: &frictions };
    let sides = told(&beside, &fit, &heads, flags.gross);
    Ok(Some(with(problem.data, &heads, &sides)))
}

/// The same beside the effects that were found, of measurements whose sides are those of the
/// order alone. What has no name may be what a wrong side looks like ("another zero from row 8
/// on"): it is set aside only for sides that are not told otherwise.
#[must_use]
pub fn found_beside(q: &Question, weighed: &Weighed, data: &Measurements) -> Option<Measurements> {
    let heads = heads(data);
    if heads.is_empty() {
        return None;
    }
    let fit = &weighed.best.fit;
    let mut state = fit.fit.state.clone();
    let mut frictions = vec![0.0; q.problem.nominal.len()];
    for term in &state.terms {
        if let ModelTerm::Arm(term) = term
            && term.effect == Effect::Backlash
        {
            frictions[usize::from(term.joint)] = term.order;
        }
    }
    state.terms.retain(|term| !is_gap(term));
    let tables: Vec<ErrorCurve> = weighed.curves.iter().map(|c| c.table.clone()).collect();
    let bent = Bent { tables, moments: weighed.moments.clone() }.problem(q.problem);
    let problem = Problem { data, ..bent.with_terms(state.terms.len()) };
    let beside = |problem: &Problem| {
        let (state, lambda) = (&state, q.flags.lambda);
        let beside = Beside { problem, state, lambda, frictions: &frictions };
        told(&beside, fit, &heads, q.flags.gross)
    };
    let mut sides = beside(&problem);
    let nameless = weighed.held_nameless();
    if sides.contains(&0) && !nameless.is_empty() {
        let others = beside(&nameless::without(&problem, &state, &nameless));
        sides.iter_mut().zip(others).filter(|(side, _)| **side == 0).for_each(|(s, o)| *s = o);
    }
    Some(with(data, &heads, &sides))
}

/// Whether sides are others than those that a model was found with, where that may matter: a side
/// that is told otherwise now, or no longer told of a joint that has a gap in the model.
#[must_use]
pub fn differ(next: &Measurements, now: &Measurements, best: &Node) -> bool {
    let gap = |joint: usize| {
        let terms = best.fit.fit.state.terms.iter();
        terms.filter(|term| is_gap(term)).any(|term| term.joints() == [joint + 1])
    };
    let gaps: Vec<bool> = (0..next.sides_found.len()).map(gap).collect();
    let side = |of: &Row, joint: usize| of.directions.get(joint).copied().unwrap_or(0);
    next.rows.iter().zip(&now.rows).any(|(next, now)| {
        let differs = |(joint, gap): (usize, &bool)| {
            let side = [side(next, joint), side(now, joint)];
            side[0] != side[1] && (side[0] != 0 || *gap)
        };
        gaps.iter().enumerate().any(differs)
    })
}

/// Whether it is of the side that a joint came from.
fn is_gap(term: &ModelTerm) -> bool {
    match term {
        ModelTerm::Arm(term) => term.effect == Effect::Backlash,
        ModelTerm::Lag { .. } => true,
        ModelTerm::Drift { .. } | ModelTerm::Remount { .. } => false,
    }
}

/// What rows tell that a fit has kept, and those of heads that it flagged for being as far off
/// as the wrong sides of gaps would put them.
fn told(beside: &Beside, fit: &RobustFit, heads: &[Head], gross: f64) -> Vec<i8> {
    let of_head = |row: &usize| heads.iter().any(|head| head.rows.contains(row));
    let flagged: Vec<usize> = fit.outliers.iter().map(|o| o.row).filter(of_head).collect();
    let kept = Gaps::of(beside, &fit.kept, heads);
    if flagged.is_empty() {
        return kept.told();
    }
    let reach = kept.reach(beside);
    let at = beside.problem.linearise(beside.state);
    let mut rows = fit.kept.clone();
    rows.extend(flagged.into_iter().filter(|row| {
        let [by_gaps, noise] = reach(*row);
        at.scaled_residual(*row).norm() < by_gaps + gross * noise
    }));
    rows.sort_unstable();
    Gaps::of(beside, &rows, heads).told()
}
