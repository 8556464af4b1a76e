//! The user's two files with the mistakes undone, everything else as it was.

mod arm;
mod numbers;
mod rows;

use super::finding::Finding;
use super::mistake::Mistake;
use super::words::Said;
use crate::error::Result;
use crate::files::{CsvEdit, not_that_text};
use crate::model::{Measurements, Robot};
pub use arm::leaves_lengths;

/// What the first line of a mended file begins with.
pub const MENDED: &str = "# truearm check: ";

/// The two texts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mended {
    /// `robot.toml`
    pub robot: String,
    /// `measurements.csv`
    pub measurements: String,
}

/// Undoes the mistakes in the texts that robot and measurements were read from.
///
/// # Errors
/// Texts that are not those.
pub fn mend(
    (robot, robot_text): (&Robot, &str),
    (data, data_text): (&Measurements, &str),
    finding: &Finding,
) -> Result<Mended> {
    let (of_data, of_robot): (Vec<_>, Vec<_>) =
        finding.changes.iter().zip(&finding.said).partition(|(change, _)| change.of_data());
    let remarks = |said: &[(&Mistake, &Said)]| {
        said.iter().map(|(_, said)| format!("{MENDED}{said}; mended\n")).collect::<String>()
    };
    let mut texts = Mended { robot: robot_text.to_owned(), measurements: data_text.to_owned() };
    if !of_robot.is_empty() {
        texts.robot = remarks(&of_robot) + &arm::mended(robot, robot_text, finding)?;
    }
    if !of_data.is_empty() {
        let mut ordered: Vec<&Mistake> = of_data.iter().map(|(change, _)| *change).collect();
        ordered.sort_by_key(|change| change.rank());
        let mut edit = CsvEdit::new(&data.path, data_text)?;
        let rows: Vec<usize> = match finding.only_rows() {
            // Rows are known by their place: none may be missing.
            Some(_) if edit.rows() != data.rows.len() => return Err(not_that_text(&data.path)),
            Some(rows) => rows.to_vec(),
            None => (0..edit.rows()).collect(),
        };
        ordered.iter().for_each(|change| rows::mend(&mut edit, robot, change, &rows));
        texts.measurements = remarks(&of_data) + &edit.finish();
    }
    Ok(texts)
}

impl Mistake {
    /// Whether measurements.csv is mended; else robot.toml is.
    pub(super) fn of_data(&self) -> bool {
        !matches!(
            self,
            Self::Convention(_) | Self::RobotUnit(_) | Self::RobotAngles | Self::Value(..)
        )
    }
}
