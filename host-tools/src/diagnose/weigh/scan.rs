//! What geometry leaves of each joint's column: ready for lines and steps of
//! unknown place.

use rayon::prelude::*;

use super::possible::revolute;
use super::sheet::{Sheet, Weights};
use crate::evidence::Geometry;
use crate::evidence::lines::JointColumn;
use crate::identify::{Problem, State};

/// What a scan is made of.
pub struct Columns {
    /// Each revolute joint, counted from 0.
    pub joints: Vec<(usize, JointColumn)>,
    /// The target along x, y and z of the last frame, without joint values.
    pub target: Vec<JointColumn>,
    /// The base about and along its axes, without joint values.
    pub base: Vec<JointColumn>,
}

/// All at the rows. A noise scale of 0 is not known yet.
#[must_use]
pub fn columns(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    weights: &Weights,
    noise: (f64, f64),
) -> Columns {
    let bare = Sheet::new(problem, state, &[], weights, &[]);
    let (geometry, scale) = geometry(&bare, rows, noise);
    let all = revolute(problem);
    let target = (0..3).into_par_iter().map(|k| bare.along(rows, &|d| d.tool[k], &geometry, scale));
    let base = (0..6).into_par_iter().map(|k| bare.along(rows, &|d| d.base[k], &geometry, scale));
    Columns {
        joints: all.par_iter().map(|j| (*j, bare.joint(rows, *j, &geometry, scale))).collect(),
        target: target.collect(),
        base: base.collect(),
    }
}

/// The joints alone.
#[must_use]
pub fn joints(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    weights: &Weights,
    noise: (f64, f64),
) -> Vec<(usize, JointColumn)> {
    let bare = Sheet::new(problem, state, &[], weights, &[]);
    let (geometry, scale) = geometry(&bare, rows, noise);
    let all = revolute(problem);
    all.par_iter().map(|j| (*j, bare.joint(rows, *j, &geometry, scale))).collect()
}

fn geometry(bare: &Sheet, rows: &[usize], (lambda, scale): (f64, f64)) -> (Geometry, f64) {
    let gram = bare.gram(rows);
    let precision = bare.precision(lambda);
    let scale = if scale > 0.0 { scale } else { gram.scale_of_geometry(&precision) };
    (gram.geometry(&precision, scale), scale)
}
