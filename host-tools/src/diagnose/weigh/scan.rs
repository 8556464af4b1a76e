//! What geometry leaves of each column: ready for lines and steps of unknown place.

use nalgebra::Vector3;

use super::possible::revolute;
use super::sheet::{Sheet, Weights};
use crate::evidence::lines::JointColumn;
use crate::identify::{Problem, State};
use crate::model::arm::Derivatives;
use crate::observations::postures;

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
    (lambda, scale): (f64, f64),
) -> Columns {
    let bare = Sheet::new(problem, state, &[], weights, &[]);
    let gram = bare.gram(rows);
    let precision = bare.precision(lambda);
    let scale = if scale > 0.0 { scale } else { gram.scale_of_geometry(&precision) };
    let geometry = gram.geometry(&precision, scale);
    let joints = revolute(problem);
    let ways = |d: &Derivatives| -> Vec<Vector3<f64>> {
        let turned = |j: &usize| *d.links[*j].joint(problem.nominal[*j].kind);
        joints.iter().map(turned).chain(d.tool).chain(d.base).collect()
    };
    let count = joints.len() + TARGET + BASE;
    let mut all = bare.along(rows, (count, &ways), &geometry, scale);
    let base = all.split_off(joints.len() + TARGET);
    let target = all.split_off(joints.len());
    let data = &problem.data.rows;
    let stood = postures(data, rows);
    let with_values = |(joint, column): (usize, JointColumn)| {
        (joint, JointColumn { q: stood.iter().map(|r| data[*r].q[joint]).collect(), ..column })
    };
    let joints = joints.into_iter().zip(all).map(with_values).collect();
    Columns { joints, target, base }
}

/// Axes that the target moves along.
const TARGET: usize = 3;

/// Axes that the base turns about and moves along.
const BASE: usize = 6;
