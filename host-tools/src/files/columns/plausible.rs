//! Values of a row that are numbers and make no sense.

use super::cells::Cells;
use crate::error::Result;

/// Degrees Celsius beyond which nobody measures an arm.
const TEMPERATURES: std::ops::RangeInclusive<f64> = -60.0..=120.0;
/// Heavier than what any arm carries, kg.
const HEAVIEST: f64 = 5_000.0;

/// N m or N that no joint holds.
const STRONGEST: f64 = 1e6;

/// N m or N of every joint, where there are columns.
pub(super) fn torques(cells: &Cells, columns: Option<&[usize]>) -> Result<Vec<f64>> {
    let one = |column: &usize| match cells.number(*column)? {
        value if value.abs() > STRONGEST => Err(cells.fail(
            *column,
            format!("{value} N m"),
            "give what the joint holds in N m or N",
        )),
        value => Ok(value),
    };
    columns.unwrap_or_default().iter().map(one).collect()
}

/// Seconds either way: past those of every clock, and of every session.
const MOST_SECONDS: f64 = 1e10;
/// Rows that no session has.
const MOST_ORDER: f64 = 1e12;

/// s
pub(super) fn time(cells: &Cells, column: Option<usize>) -> Result<Option<f64>> {
    match (cells.optional(column)?, column) {
        (Some(value), Some(column)) if value.abs() > MOST_SECONDS => {
            let clock = if value < 1e14 { "; these look like milliseconds" } else { "" };
            let help = format!("give seconds, of any clock{clock}");
            Err(cells.fail(column, format!("{value:?} s"), &help))
        }
        (value, _) => Ok(value),
    }
}

/// The place of a row in the session.
pub(super) fn order(cells: &Cells, column: Option<usize>) -> Result<Option<f64>> {
    match (cells.optional(column)?, column) {
        (Some(value), Some(column)) if value.abs() > MOST_ORDER => {
            let help = "give the number of the row in the session";
            Err(cells.fail(column, format!("order {value:?}"), help))
        }
        (value, _) => Ok(value),
    }
}

/// Degrees Celsius.
pub(super) fn temperature(cells: &Cells, column: Option<usize>) -> Result<Option<f64>> {
    match (cells.optional(column)?, column) {
        (Some(value), Some(column)) if !TEMPERATURES.contains(&value) => {
            let kelvin =
                if (200.0..400.0).contains(&value) { "; these look like kelvin" } else { "" };
            let help = format!("give degrees Celsius{kelvin}");
            Err(cells.fail(column, format!("{value} degrees Celsius"), &help))
        }
        (value, _) => Ok(value),
    }
}

/// kg
pub(super) fn payload(cells: &Cells, column: Option<usize>) -> Result<Option<f64>> {
    match (cells.optional(column)?, column) {
        (Some(value), Some(column)) if !(0.0..=HEAVIEST).contains(&value) => Err(cells.fail(
            column,
            format!("payload of {value} kg"),
            "give a mass in kg, 0 or more",
        )),
        (value, _) => Ok(value),
    }
}
