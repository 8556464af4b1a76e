//! On which side of its gap a joint rested before it first moved: where the order of the
//! rows tells the sides, nothing tells the first. In a session that moves one joint after
//! another that are most of the rows of the last one.

use nalgebra::DVector;

use super::weigh::{Weights, scan, slips};
use crate::error::Result;
use crate::evidence::lines::JointColumn;
use crate::identify::fit::robust::{Flags, robust_fit};
use crate::identify::{Problem, State};
use crate::model::Measurements;
use crate::observations::postures;

/// Fewest poses that a side is found for: at one alone a gross row would look like a gap.
const FEWEST: usize = 2;

/// The measurements with the first side of each joint that waited, the one that leaves less;
/// `None` where none waited.
///
/// # Errors
/// When geometry cannot be fitted.
pub fn found(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    flags: Flags,
) -> Result<Option<Measurements>> {
    let joints = 0..problem.nominal.len();
    if joints.clone().all(|joint| waiting(problem, joint).is_empty()) {
        return Ok(None);
    }
    let fit = robust_fit(problem, rows, start, flags)?;
    let weights = Weights { rows: vec![1.0; problem.data.rows.len()], common: 0.0 };
    let noise = (flags.lambda, 0.0);
    let columns = scan::columns(problem, &fit.fit.state, &fit.kept, &weights, noise).joints;
    let stood = postures(&problem.data.rows, &fit.kept);
    let mut out = problem.data.clone();
    for joint in joints {
        let waited = waiting(problem, joint);
        let Some((_, column)) = columns.iter().find(|(of, _)| *of == joint) else { continue };
        if waited.is_empty() {
            continue;
        }
        let explained = |first: i8| {
            let of =
                |row: &usize| if waited.contains(row) { first } else { side(problem, *row, joint) };
            let sides: Vec<f64> = stood.iter().map(|row| f64::from(of(row))).collect();
            explained(column, &sides)
        };
        let first = if explained(1) >= explained(-1) { 1 } else { -1 };
        for row in waited {
            let sides = &mut out.rows[row].directions;
            sides.resize(problem.nominal.len(), 0);
            sides[joint] = first;
        }
    }
    Ok(Some(out))
}

fn side(problem: &Problem, row: usize, joint: usize) -> i8 {
    problem.data.rows[row].directions.get(joint).copied().unwrap_or(0)
}

/// Rows before a joint's first move, where there are enough of them and it moves at all.
fn waiting(problem: &Problem, joint: usize) -> Vec<usize> {
    let data = &problem.data;
    if !data.directions_from_order {
        return Vec::new();
    }
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let order = slips::in_order(problem, &rows).into_iter();
    let waited: Vec<usize> = order.take_while(|row| side(problem, *row, joint) == 0).collect();
    let mut poses: Vec<usize> = waited.iter().map(|row| data.rows[*row].pose).collect();
    poses.dedup();
    if poses.len() < FEWEST || waited.len() == rows.len() { Vec::new() } else { waited }
}

/// Fall of the sum of squares by a joint that is off by what it rests at, times these.
fn explained(column: &JointColumn, sides: &[f64]) -> f64 {
    let (mut square, mut right) = (0.0, 0.0);
    let mut imitated = DVector::zeros(column.imitated.nrows());
    for (k, side) in sides.iter().enumerate() {
        square += side * side * column.square[k];
        right += side * column.right[k];
        imitated.axpy(*side, &column.imitated.column(k), 1.0);
    }
    right * right / (square - imitated.norm_squared()).max(f64::MIN_POSITIVE)
}
