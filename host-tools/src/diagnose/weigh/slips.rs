//! What is another from some row on: a joint's zero, where the target sits, where the arm
//! stands.

use nalgebra::DVector;

use super::follows::Part;
use super::nameless::Nameless;
use super::scan::Columns;
use super::sheet::Way;
use crate::identify::Problem;
use crate::observations::postures;

/// Share of a step's column that geometry must not imitate.
const SEEN: f64 = 1e-4;

/// A step of the target so few rows beside the first of a series is the remount, which is
/// listed: noise puts a row or two on the wrong side (row 36 of 61 in place of 37, for a shift
/// of 1.5 floors, which was lost to it).
const BESIDE: usize = 3;

/// So many places lie on either side of a step. What fewer do is what rows do that are wrong, or
/// the first ones where directions are taken from the order: of no earlier row is it told from
/// which side they came ("elsewhere from row 2 on", or 3, was said of three of 190 sessions). No study
/// set the number.
const EITHER_SIDE: usize = 5;

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
    let place = problem.data.places();
    let mut order: Vec<usize> = (0..postures.len()).collect();
    order.sort_by(|a, b| place[postures[*a]].total_cmp(&place[postures[*b]]));
    order
}

/// The strongest step along a way: rows pass from the last to the first, each with the sums
/// of all that come after it.
fn strongest(way: Way, order: &[usize]) -> Step {
    let mut best = Step::default();
    let (mut square, mut right) = (0.0, 0.0);
    let mut imitated = DVector::zeros(way.along.unknowns());
    for (before, k) in order.iter().enumerate().rev() {
        let [own_square, own_right] = way.add(*k, &mut imitated);
        square += own_square;
        right += own_right;
        if before < EITHER_SIDE || order.len() - before < EITHER_SIDE {
            continue;
        }
        let left = square - imitated.norm_squared();
        let explained = right * right / left;
        if left > SEEN * square && explained > best.explained {
            best = Step { explained, shift: right / left, at: *k };
        }
    }
    best
}

/// The strongest step of each revolute joint, counted from 0.
pub fn of_joints(columns: &Columns, order: &[usize]) -> impl Iterator<Item = (usize, Step)> {
    let steps = move |joint: usize| {
        let ways = columns.ways(Part::Joint(joint));
        ways.map(move |way| (joint, strongest(way, order)))
    };
    columns.joints().iter().copied().flat_map(steps)
}

/// Where series begin that came one after another, but the first, as places in the order of
/// measurement; none where they came in turns.
fn beginnings(problem: &Problem, postures: &[usize], order: &[usize]) -> Vec<usize> {
    let series = |k: usize| &problem.data.rows[postures[order[k]]].series;
    let out: Vec<usize> = (1..order.len()).filter(|k| series(*k) != series(k - 1)).collect();
    if out.len() < problem.conditions.series.len() { out } else { Vec::new() }
}

/// The strongest step of each joint, and of the target and the base.
pub fn offered(problem: &Problem, rows: &[usize], columns: &Columns) -> Vec<Nameless> {
    let postures = postures(&problem.data.rows, rows);
    let order = in_order(problem, &postures);
    let found = of_joints(columns, &order);
    let found = found.filter(|(_, step)| step.explained > 0.0);
    let slip = |(joint, step): (usize, Step)| Nameless::Slip { joint, row: postures[step.at] };
    let mut out: Vec<Nameless> = found.map(slip).collect();
    // What moves as a whole shows along one of its axes first.
    let whole = |ways: &mut dyn Iterator<Item = Way>| {
        let steps = ways.map(|way| strongest(way, &order));
        let best = steps.max_by(|a, b| a.explained.total_cmp(&b.explained));
        best.filter(|step| step.explained > 0.0).map(|step| postures[step.at])
    };
    let begins = beginnings(problem, &postures, &order);
    let listed = |row: &usize| {
        let at = order.iter().position(|k| postures[*k] == *row);
        at.is_some_and(|at| begins.iter().any(|begin| begin.abs_diff(at) <= BESIDE))
    };
    let reseated = whole(&mut columns.ways(Part::Target)).filter(|row| !listed(row));
    let reseated = reseated.map(|row| Nameless::Reseated { row });
    let shifted = whole(&mut columns.base()).map(|row| Nameless::Shifted { row });
    out.extend(reseated.into_iter().chain(shifted));
    out
}

/// How many like it were looked at.
#[must_use]
pub fn tried(columns: &Columns, rows: &[usize], step: &Nameless) -> usize {
    let of_joint = matches!(step, Nameless::Slip { .. });
    rows.len() * if of_joint { columns.joints().len() } else { 1 }
}
