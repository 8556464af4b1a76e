//! How well numbers agree with a nominal arm, whatever frame they are in:
//! distances between points and angles between orientations stay the same in
//! every frame.

use nalgebra::{Matrix3, Vector3};
use truearm::Pose;

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

/// A nominal arm that moves less between two rows stands still, m: repetitions of a
/// pose say nothing.
pub(super) const MOVED: f64 = 1e-6;

/// Logarithms of the distances between pairs of rows; `None` of a pair that did
/// not move.
#[derive(Debug, Clone)]
pub(super) struct Distances(Vec<Option<f64>>);

impl Distances {
    /// Of points, m, that moved by more than this.
    pub fn of(points: &[Vector3<f64>], moved: f64) -> Self {
        let log = |(i, j): (usize, usize)| {
            let distance = (points[i] - points[j]).norm();
            (distance > moved).then(|| distance.ln())
        };
        Self(pairs(points.len()).map(log).collect())
    }

    /// The median of |ln(these / others)|; 0 where all distances agree. `None` of
    /// fewer than four pairs that moved, and beyond `most`, which is seen before
    /// all pairs are.
    pub fn misfit(&self, others: &Self, most: f64) -> Option<f64> {
        let (mut all, mut beyond) = (Vec::new(), 0);
        for (a, b) in self.0.iter().zip(&others.0) {
            let (Some(a), Some(b)) = (a, b) else { continue };
            let off = (a - b).abs();
            beyond += usize::from(off > most);
            if 2 * beyond > self.0.len() {
                return None;
            }
            all.push(off);
        }
        if all.len() < 4 { None } else { median(all).filter(|misfit| *misfit <= most) }
    }
}

/// How far measured distances are from the nominal arm's, see
/// [`Distances::misfit`]; of distances that are `far`, see [`moved`]. `q` in rad and m, points
/// in m.
pub(super) fn distances(
    robot: &Robot,
    q: &[Vec<f64>],
    points: &[Vector3<f64>],
    far: bool,
) -> Option<f64> {
    let target = robot.nominal_target();
    let count = q.len().min(points.len());
    let nominal: Vec<Vector3<f64>> = q[..count].iter().map(|q| target(q).translation).collect();
    let moved = if far { moved(&nominal) } else { MOVED };
    let nominal = Distances::of(&nominal, moved);
    Distances::of(&points[..count], 0.0).misfit(&nominal, f64::INFINITY)
}

/// What distances of a nominal arm are not small among all, m: where it meets one point with
/// its elbow up and down, what it is off by is all that is between the two.
pub(super) fn moved(nominal: &[Vector3<f64>]) -> f64 {
    let apart = |(i, j): (usize, usize)| (nominal[i] - nominal[j]).norm();
    let most = pairs(nominal.len()).map(apart).fold(0.0, f64::max);
    MOVED.max(NOT_SMALL * most)
}

/// Part of the largest distance.
const NOT_SMALL: f64 = 0.05;

/// The median difference, rad, of angles that no frame changes: of the turn from
/// one orientation to another, and of two such turns after each other. The second
/// tells forms apart that the first does not: a quaternion whose numbers change
/// places keeps all angles to its like.
pub(super) fn turns(robot: &Robot, q: &[Vec<f64>], measured: &[Matrix3<f64>]) -> Option<f64> {
    let target = robot.nominal_target();
    let nominal: Vec<Matrix3<f64>> = q.iter().map(|q| target(q).rotation).collect();
    let angle = |m: &Matrix3<f64>| {
        Pose { rotation: *m, translation: Vector3::zeros() }.rotation_vector().norm()
    };
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
