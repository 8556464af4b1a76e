//! What is another from some row on: a joint's zero, where the target sits, where the arm
//! stands.

use nalgebra::DVector;

use super::nameless::Nameless;
use super::possible::{Numbers, Possible};
use super::scan::Columns;
use crate::evidence::lines::JointColumn;
use crate::identify::Problem;
use crate::observations::postures;

/// Share of a step's column that geometry must not imitate.
const SEEN: f64 = 1e-4;

/// A step of the target where a series begins is a remount, which is listed: one elsewhere
/// is looked for only if the best at such a place explains less than this share of it. A few
/// rows beside the place are on the wrong side by noise (row 36 in place of 37 of 61, for a
/// shift of 1.5 floors; the remount was lost to it).
const AS_GOOD: f64 = 0.8;

/// The step of a joint's value that explains most.
#[derive(Debug, Clone, Copy, Default)]
pub struct Step {
    /// Fall of the weighted sum of squares.
    pub explained: f64,
    /// rad, or m of a joint that slides.
    pub shift: f64,
    /// First row after it, a place among those scanned.
    pub at: usize,
}

/// Where the arm stood in the order of measurement, as places among `postures`.
#[must_use]
pub fn in_order(problem: &Problem, postures: &[usize]) -> Vec<usize> {
    let when = |k: &usize| problem.data.when(postures[*k]);
    let mut order: Vec<usize> = (0..postures.len()).collect();
    order.sort_by(|a, b| when(a).total_cmp(&when(b)));
    order
}

/// The strongest step: rows pass from the last to the first, each with the sums
/// of all that come after it.
#[must_use]
pub fn strongest(column: &JointColumn, order: &[usize]) -> Step {
    strongest_of(column, order, |_| true)
}

/// The same of steps at some places.
fn strongest_of(column: &JointColumn, order: &[usize], at: impl Fn(usize) -> bool) -> Step {
    let mut best = Step::default();
    let (mut square, mut right) = (0.0, 0.0);
    let mut imitated = DVector::zeros(column.imitated.nrows());
    for k in order.iter().skip(1).rev() {
        square += column.square[*k];
        right += column.right[*k];
        imitated += column.imitated.column(*k);
        let left = square - imitated.norm_squared();
        let explained = right * right / left;
        if left > SEEN * square && explained > best.explained && at(*k) {
            best = Step { explained, shift: right / left, at: *k };
        }
    }
    best
}

/// First rows of series that came one after another, but of the first, as places among
/// `postures`; none where series came in turns.
fn beginnings(problem: &Problem, postures: &[usize], order: &[usize]) -> Vec<usize> {
    let series = |k: usize| &problem.data.rows[postures[k]].series;
    let pairs = order.windows(2).filter(|pair| series(pair[0]) != series(pair[1]));
    let out: Vec<usize> = pairs.map(|pair| pair[1]).collect();
    if out.len() < problem.conditions.series.len() { out } else { Vec::new() }
}

/// The strongest step of each joint as a candidate, and of the target and the base.
pub fn offered(
    problem: &Problem,
    rows: &[usize],
    columns: &Columns,
    numbers: &mut Numbers,
) -> Vec<Possible> {
    let postures = postures(&problem.data.rows, rows);
    let order = in_order(problem, &postures);
    let steps = columns.joints.iter().map(|(joint, column)| (*joint, strongest(column, &order)));
    let found = steps.filter(|(_, step)| step.explained > 0.0);
    let slip = |(joint, step): (usize, Step)| Nameless::Slip { joint, row: postures[step.at] };
    let of_joints = columns.joints.len() * rows.len();
    let mut out: Vec<Possible> =
        found.map(|step| numbers.nameless(slip(step), of_joints)).collect();
    // What moves as a whole shows along one of its axes first.
    let whole = |columns: &[JointColumn], at: &dyn Fn(usize) -> bool| {
        let steps = columns.iter().map(|column| strongest_of(column, &order, at));
        steps.max_by(|a, b| a.explained.total_cmp(&b.explained)).filter(|s| s.explained > 0.0)
    };
    let begins = beginnings(problem, &postures, &order);
    let listed = whole(&columns.target, &|k| begins.contains(&k)).map_or(0.0, |s| s.explained);
    let reseated = whole(&columns.target, &|_| true)
        .filter(|step| listed < AS_GOOD * step.explained)
        .map(|step| Nameless::Reseated { row: postures[step.at] });
    let shifted =
        whole(&columns.base, &|_| true).map(|step| Nameless::Shifted { row: postures[step.at] });
    for what in reseated.into_iter().chain(shifted) {
        out.push(numbers.nameless(what, rows.len()));
    }
    out
}
