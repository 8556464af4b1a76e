//! Which joints have an error curve, by the evidence.

use super::curves::Curve;
use super::possible::{Possible, columns_of, revolute};
use super::sheet::{Sheet, Weights};
use crate::evidence::prior;
use crate::evidence::smooth::{self, Prior};
use crate::identify::{Problem, State};

/// Poses that an order needs.
const POSES_AN_ORDER: usize = 4;

/// Which joints have a curve, beside what else was found, and their priors.
#[must_use]
pub fn chosen(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    members: &[Possible],
    weights: &Weights,
    (lambda, scale): (f64, f64),
) -> Vec<Curve> {
    let joints = revolute(problem);
    let most = problem.data.poses / POSES_AN_ORDER;
    let Some(length) = smooth::LENGTHS.into_iter().find(|l| smooth::orders(*l) <= most) else {
        return Vec::new();
    };
    let size = smooth::SIZES[0];
    let all: Vec<Curve> =
        joints.iter().map(|joint| Curve { joint: *joint, prior: Prior { length, size } }).collect();
    let sheet = Sheet::new(problem, state, members, weights, &all).with_curves_apart();
    let gram = sheet.gram(rows);
    let projected = gram.project(&gram.geometry(&sheet.precision(lambda), scale));
    let log_odds = prior::log_odds(joints.len(), 1);
    let priors = smooth::choose(&projected, columns_of(members), smooth::orders(length), log_odds);
    let found = joints.iter().zip(priors);
    found.filter_map(|(joint, prior)| Some(Curve { joint: *joint, prior: prior? })).collect()
}
