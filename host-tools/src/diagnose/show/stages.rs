use rayon::prelude::*;

use crate::diagnose::node::{Node, fitted};
use crate::diagnose::question::Question;
use crate::error::Result;

/// Effects that a model has, by name.
fn names(node: &Node) -> Vec<&'static str> {
    let mut out: Vec<&'static str> = Vec::new();
    for candidate in &node.added {
        if !out.contains(&candidate.name()) {
            out.push(candidate.name());
        }
    }
    out
}

fn with(q: &Question, best: &Node, chosen: &[&str]) -> Result<Node> {
    let added = best.added.iter().filter(|c| chosen.contains(&c.name())).cloned().collect();
    fitted(q, added, &best.fit.fit.state)
}

/// What a model leaves of held-out poses without one of its effects, all others kept.
pub struct Without {
    /// The effect.
    pub name: &'static str,
    /// The rest, `None` where it cannot be fitted.
    pub node: Option<Node>,
    /// RMS of the held-out poses, sigmas.
    pub left: f64,
}

/// A model without each of its effects in turn, the one that it needs most first.
pub fn without_each(
    q: &Question,
    best: &Node,
    held_out: &(dyn Fn(&Node) -> Result<f64> + Sync),
) -> Vec<Without> {
    let all = names(best);
    let one = |name: &&'static str| {
        let others: Vec<&str> = all.iter().copied().filter(|n| n != name).collect();
        let judged = with(q, best, &others).and_then(|node| Ok((held_out(&node)?, node)));
        // What converges with it alone needs it.
        let (left, node) = judged.map_or((f64::INFINITY, None), |(left, node)| (left, Some(node)));
        Without { name, node, left }
    };
    let mut out: Vec<Without> = all.par_iter().map(one).collect();
    out.sort_by(|a, b| b.left.total_cmp(&a.left));
    out
}

/// The models from geometry to the final one: each adds all terms of one effect, in the
/// order given.
///
/// # Errors
/// When an intermediate fit does not converge.
pub fn stages(q: &Question, root: &Node, best: &Node, order: &[Without]) -> Result<Vec<Node>> {
    let names: Vec<&str> = order.iter().map(|w| w.name).collect();
    let between = (1..names.len()).map(|k| with(q, best, &names[..k]));
    let mut out = vec![root.clone()];
    out.extend(between.collect::<Result<Vec<_>>>()?);
    if !names.is_empty() {
        out.push(best.clone());
    }
    Ok(out)
}
