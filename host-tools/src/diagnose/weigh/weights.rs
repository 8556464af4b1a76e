//! How much each row counts after a fit: tails and what the readings of a pose
//! have in common.

use super::sheet::Weights;
use crate::diagnose::node::Node;
use crate::evidence::poses::{self, Readings, Scatter, common_share};
use crate::evidence::tails::{Rest, Tails};
use crate::identify::Problem;
use crate::observations::Reading;

/// What rows weigh after a fit.
#[must_use]
pub fn after(problem: &Problem, node: &Node) -> Weights {
    let at = problem.linearise(&node.fit.fit.state);
    let kept = &node.fit.kept;
    let residuals: Vec<Vec<f64>> =
        kept.iter().map(|row| at.scaled_residual(*row).to_vec()).collect();
    let rest = |r: &Vec<f64>| Rest { square: r.iter().map(|x| x * x).sum(), equations: r.len() };
    let rests: Vec<Rest> = residuals.iter().map(rest).collect();
    let used = problem.unknowns.list().len() as f64;
    let tails = Tails::of(&rests, used.min(rests.len() as f64));
    let mut rows = vec![1.0; problem.data.rows.len()];
    for (row, rest) in kept.iter().zip(&rests) {
        rows[*row] = tails.weight(*rest);
    }
    // Share of the noise that the readings of a pose have in common.
    let common = common_share(&readings(problem, kept, &residuals), used);
    Weights { rows, common }
}

/// How readings of a pose, and poses, scatter after a fit of so many unknowns, in sigmas.
#[must_use]
pub fn scatter(problem: &Problem, node: &Node) -> Option<Scatter> {
    let at = problem.linearise(&node.fit.fit.state);
    let of = |row: &usize| at.scaled_residual(*row).to_vec();
    let residuals: Vec<Vec<f64>> = node.fit.kept.iter().map(of).collect();
    let used = problem.unknowns.list().len() as f64;
    poses::scatter(&readings(problem, &node.fit.kept, &residuals), used)
}

/// Residuals by the pose that they were read at.
fn readings(problem: &Problem, kept: &[usize], residuals: &[Vec<f64>]) -> Vec<Readings> {
    let key = |k: usize| Reading::of(&problem.data.rows, kept[k]);
    let mut order: Vec<usize> = (0..kept.len()).collect();
    order.sort_by_cached_key(|k| (key(*k), *k));
    let poses = order.chunk_by(|a, b| key(*a) == key(*b)).map(|readings| {
        let equations = residuals[readings[0]].len();
        Readings::from_fn(equations, readings.len(), |e, r| residuals[readings[r]][e])
    });
    poses.collect()
}
