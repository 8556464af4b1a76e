use std::path::Path;

use truearm::JointKind;

use super::columns::{Cells, Columns};
use crate::error::{Error, Place, Result};
use crate::model::near::Reach;
use crate::model::{Measurements, Robot};

/// Rows whose joints agree within this are one pose, rad (0.01 degrees).
const SAME_ANGLE: f64 = 0.01 * std::f64::consts::PI / 180.0;
/// The same for a prismatic joint, m.
const SAME_LENGTH: f64 = 1e-5;

impl Measurements {
    /// Reads and checks the measurements of `robot`.
    ///
    /// # Errors
    /// Names file, line, column and remedy.
    pub fn read(path: &Path, robot: &Robot) -> Result<Self> {
        Self::parse(path, &super::read(path)?, robot)
    }

    /// Like [`Measurements::read`] from a text.
    ///
    /// # Errors
    /// As for [`Measurements::read`].
    pub fn parse(path: &Path, text: &str, robot: &Robot) -> Result<Self> {
        let mut data = Self::table(path, text, robot, Some("q"))?;
        data.remark(robot);
        Ok(data)
    }

    /// The rows of a file whose joint columns begin with `joints`.
    pub(super) fn table(
        path: &Path,
        text: &str,
        robot: &Robot,
        joints: Option<&str>,
    ) -> Result<Self> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let fail = |e: csv::Error| {
            let place =
                e.position().map_or_else(Place::default, |p| Place::line(p.line() as usize));
            Error::file(path, place, e.to_string(), "write one comma-separated row a measurement")
        };
        let names: Vec<String> =
            reader.headers().map_err(fail)?.iter().map(str::to_owned).collect();
        let columns = Columns::find(path, &names, robot, joints)?;
        let mut data = Self {
            path: path.to_owned(),
            rows: Vec::new(),
            stations: Vec::new(),
            markers: Vec::new(),
            poses: 0,
            extra_columns: columns.extra.iter().map(|c| names[*c].clone()).collect(),
            warnings: Vec::new(),
        };
        for record in reader.records() {
            let record = record.map_err(fail)?;
            let line = record.position().map_or(0, |p| p.line() as usize);
            if record.len() != names.len() {
                return Err(Error::file(
                    path,
                    Place::line(line),
                    format!("{} cells where the header has {}", record.len(), names.len()),
                    "give every row a cell for every column; leave unknown ones empty",
                ));
            }
            let cells = Cells { path, line, names: &names, record: &record };
            let row = columns.row(&cells, robot, &mut data.stations, &mut data.markers)?;
            data.rows.push(row);
        }
        if data.rows.is_empty() {
            return Err(Error::file(path, Place::default(), "no data rows", "add measurements"));
        }
        if joints.is_some() {
            let reach = Reach::of_joints(robot, SAME_ANGLE, SAME_LENGTH);
            let numbers;
            (numbers, data.poses) = reach.number(data.rows.iter().map(|row| row.q.as_slice()));
            data.rows.iter_mut().zip(numbers).for_each(|(row, number)| row.pose = number);
        }
        Ok(data)
    }

    /// Things that look wrong but may be meant.
    fn remark(&mut self, robot: &Robot) {
        let mut warn =
            |text: String| self.warnings.push(format!("{}: {text}", self.path.display()));
        if !self.extra_columns.is_empty() {
            warn(format!("columns kept without use: {}", self.extra_columns.join(", ")));
        }
        let revolute = |j: usize| robot.joints[j].link.kind == JointKind::Revolute;
        let seven = 7_f64.to_radians();
        let mut angles = self.rows.iter().flat_map(|r| {
            r.q.iter().enumerate().filter(|(j, _)| revolute(*j)).map(|(_, q)| q.abs())
        });
        if (0..robot.joints.len()).any(revolute) && angles.all(|q| q < seven) {
            warn(
                "all joint angles are below 7 degrees: are they radians? The columns are degrees"
                    .to_owned(),
            );
        }
        for (j, joint) in robot.joints.iter().enumerate() {
            let Some([low, high]) = joint.limits else { continue };
            let outside = self.rows.iter().filter(|r| r.q[j] < low || r.q[j] > high);
            let lines: Vec<_> = outside.map(|r| r.line).collect();
            if let Some(first) = lines.first() {
                let count = lines.len();
                warn(format!(
                    "joint {} outside its limits in {count} rows, first in line {first}",
                    j + 1
                ));
            }
        }
    }
}
