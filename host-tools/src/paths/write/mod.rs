//! Corrected joints in the language of a robot.

mod ros2;
mod template;
mod urscript;

pub use ros2::{Timing, ros2};
pub use template::Template;
pub use urscript::{Move, urscript};

use truearm::Pose;

use super::compensate::{Compensated, Row};
use crate::error::{Error, ErrorKind, Result};
use crate::model::Path;

/// A row of a program.
pub(super) struct Point<'a> {
    /// rad or m
    pub joints: &'a [f64],
    /// Where the controller then believes its tool to be, in `[base]`.
    pub believed: &'a Pose<f64>,
    /// `time_s` of the row.
    pub time: Option<f64>,
    /// Its cells in the input.
    pub cells: &'a [String],
    /// The line of the input.
    pub line: usize,
}

/// All rows of a program.
///
/// # Errors
/// A row that the arm does not reach: a program must not leave one out; a result
/// that is no number.
pub(super) fn points<'a>(path: &'a Path, found: &'a Compensated) -> Result<Vec<Point<'a>>> {
    let rows = found.rows.iter().zip(&path.data.rows).zip(&path.cells);
    rows.map(|((row, input), cells)| match row {
        Row::Corrected { joints, believed, .. } => {
            let numbers = joints.iter().chain(&believed.translation).chain(&believed.rotation);
            if let Some(x) = numbers.copied().find(|x| !x.is_finite()) {
                let line = format!("{}, line {}", path.data.path.display(), input.line);
                return Err(Error::not_finite(&line, x));
            }
            Ok(Point { joints, believed, time: input.time, cells, line: input.line })
        }
        Row::NotReached(_) => Err(Error::data(
            ErrorKind::NoPoses,
            format!("{}: line {} is not reached", path.data.path.display(), input.line),
            "a program with a hole is not written: mend the path, or give --start near its first \
             row; --format csv shows every row",
        )),
    })
    .collect()
}
