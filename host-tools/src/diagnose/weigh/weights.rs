//! How much each row counts after a fit: tails and what the readings of a pose
//! have in common.

use super::sheet::Weights;
use crate::diagnose::node::Node;
use crate::evidence::poses::{Readings, common_share};
use crate::evidence::tails::{Rest, Tails};
use crate::identify::Problem;
use crate::observations::Reading;

/// What rows weigh after a fit.
#[must_use]
pub fn after(problem: &Problem, node: &Node) -> Weights {
    let at = problem.linearise(&node.fit.fit.state);
    let scaled =
        |row: usize| at.residual(row).values().zip_map(&problem.scale(row), |r, s| r / s).to_vec();
    let kept = &node.fit.kept;
    let residuals: Vec<Vec<f64>> = kept.iter().map(|row| scaled(*row)).collect();
    let rest = |r: &Vec<f64>| Rest { square: r.iter().map(|x| x * x).sum(), equations: r.len() };
    let rests: Vec<Rest> = residuals.iter().map(rest).collect();
    let used = problem.unknowns.list().len() as f64;
    let tails = Tails::of(&rests, used.min(rests.len() as f64));
    let mut rows = vec![1.0; problem.data.rows.len()];
    for (row, rest) in kept.iter().zip(&rests) {
        rows[*row] = tails.weight(*rest);
    }
    Weights { rows, common: common(problem, kept, &residuals, used) }
}

/// Share of the noise that the readings of a pose have in common.
fn common(problem: &Problem, kept: &[usize], residuals: &[Vec<f64>], used: f64) -> f64 {
    let key = |k: usize| Reading::of(&problem.data.rows, kept[k]);
    let mut order: Vec<usize> = (0..kept.len()).collect();
    order.sort_by_cached_key(|k| (key(*k), *k));
    let poses = order.chunk_by(|a, b| key(*a) == key(*b)).map(|readings| {
        let equations = residuals[readings[0]].len();
        Readings::from_fn(equations, readings.len(), |e, r| residuals[readings[r]][e])
    });
    common_share(&poses.collect::<Vec<_>>(), used)
}
