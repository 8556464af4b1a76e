//! What geometry leaves of each joint's column: ready for lines and steps of
//! unknown place.

use rayon::prelude::*;

use super::possible::revolute;
use super::sheet::{Sheet, Weights};
use crate::evidence::lines::JointColumn;
use crate::identify::{Problem, State};

/// Each revolute joint, counted from 0, with its column at the rows. A noise
/// scale of 0 is not known yet.
#[must_use]
pub fn joints(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    weights: &Weights,
    (lambda, scale): (f64, f64),
) -> Vec<(usize, JointColumn)> {
    let bare = Sheet::new(problem, state, &[], weights, &[]);
    let gram = bare.gram(rows);
    let precision = bare.precision(lambda);
    let scale = if scale > 0.0 { scale } else { gram.scale_of_geometry(&precision) };
    let geometry = gram.geometry(&precision, scale);
    let joints = revolute(problem);
    joints.par_iter().map(|j| (*j, bare.joint(rows, *j, &geometry, scale))).collect()
}
