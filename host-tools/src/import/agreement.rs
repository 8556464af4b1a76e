//! How well numbers agree with a nominal arm, whatever frame they are in:
//! distances between points and angles between orientations stay the same in
//! every frame.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::model::Robot;

/// Pairs of rows that are compared at most.
const PAIRS: usize = 600;

/// Pairs of `count` rows: neighbours, and rows half the table apart.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    let next = (1..count).map(|i| (i - 1, i));
    let far = (0..count / 2).map(move |i| (i, i + count / 2));
    let step = (count / PAIRS).max(1);
    next.chain(far).step_by(step)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The median of |ln(measured / nominal distance)| of pairs of points; 0 where
/// all distances agree. `None` of fewer than four pairs that moved. `q` in rad
/// and m, points in m.
pub(super) fn distances(robot: &Robot, q: &[Vec<f64>], points: &[Vector3<f64>]) -> Option<f64> {
    let target = robot.nominal_target();
    let nominal: Vec<Vector3<f64>> = q.iter().map(|q| target(q).translation).collect();
    let log = |(i, j): (usize, usize)| {
        let (a, b) = ((points[i] - points[j]).norm(), (nominal[i] - nominal[j]).norm());
        // Repetitions of a pose say nothing.
        (a > 0.0 && b > 1e-6).then(|| (a / b).ln().abs())
    };
    let all: Vec<f64> = pairs(q.len().min(points.len())).filter_map(log).collect();
    if all.len() < 4 { None } else { median(all) }
}

/// The median difference, rad, of angles that no frame changes: of the turn from
/// one orientation to another, and of two such turns after each other. The second
/// tells forms apart that the first does not: a quaternion whose numbers change
/// places keeps all angles to its like.
pub(super) fn turns(robot: &Robot, q: &[Vec<f64>], measured: &[Matrix3<f64>]) -> Option<f64> {
    let target = robot.nominal_target();
    let nominal: Vec<Matrix3<f64>> = q.iter().map(|q| target(q).rotation).collect();
    let angle = |m: &Matrix3<f64>| Rotation3::from_matrix_unchecked(*m).angle();
    let count = q.len().min(measured.len());
    let difference = |(i, j): (usize, usize)| {
        let (k, l) = ((i + 2) % count, (j + 3) % count);
        let of = |turns: &[Matrix3<f64>]| {
            let one = turns[i].transpose() * turns[j];
            [angle(&one), angle(&(one * turns[k].transpose() * turns[l]))]
        };
        let (a, b) = (of(measured), of(&nominal));
        (a[0] - b[0]).abs().max((a[1] - b[1]).abs())
    };
    let all: Vec<f64> = pairs(count).map(difference).collect();
    if all.len() < 4 { None } else { median(all) }
}
