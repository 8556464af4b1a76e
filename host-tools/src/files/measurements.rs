use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use truearm::JointKind;

use super::Robot;
use super::columns::{Cells, Columns};
use crate::error::{Error, Place, Result};
use crate::near::Reach;

/// Rows whose joints agree within this are one pose, rad (0.01 degrees).
const SAME_ANGLE: f64 = 0.01 * std::f64::consts::PI / 180.0;
/// The same for a prismatic joint, m.
const SAME_LENGTH: f64 = 1e-5;

/// The rows of a `measurements.csv`, in SI units.
#[derive(Debug, Clone)]
pub struct Measurements {
    /// The file they came from.
    pub path: PathBuf,
    /// One entry a data row, in file order.
    pub rows: Vec<Row>,
    /// Labels of the tracker stations; one empty label without the column.
    pub stations: Vec<String>,
    /// Labels of the markers; one empty label without the column.
    pub markers: Vec<String>,
    /// Number of distinct poses.
    pub poses: usize,
    /// Names of columns without a meaning to truearm; their cells are in [`Row::extra`].
    pub extra_columns: Vec<String>,
    /// Remarks for the user.
    pub warnings: Vec<String>,
}

/// One measured point.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Line of the file.
    pub line: usize,
    /// Encoder readings, rad or m.
    pub q: Vec<f64>,
    /// Measured point in the tracker frame, m.
    pub point: Vector3<f64>,
    /// Standard deviation of a coordinate, m.
    pub sigma: f64,
    /// Index into [`Measurements::stations`].
    pub station: usize,
    /// Index into [`Measurements::markers`].
    pub marker: usize,
    /// Number of the pose; rows with the same joints share it.
    pub pose: usize,
    /// Label of the series.
    pub series: Option<String>,
    /// Seconds since the session's start.
    pub time: Option<f64>,
    /// Degrees Celsius.
    pub temperature: Option<f64>,
    /// kg
    pub payload: Option<f64>,
    /// Order of measurement.
    pub order: Option<f64>,
    /// Orientation of the target in the tracker frame, quaternion x, y, z, w.
    pub orientation: Option<[f64; 4]>,
    /// Side from which each joint came to rest: +1, -1, or 0 if unknown.
    pub directions: Vec<i8>,
    /// Cells of [`Measurements::extra_columns`].
    pub extra: Vec<String>,
}

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

    /// Smallest and largest value of each joint.
    #[must_use]
    pub fn covered(&self) -> Vec<[f64; 2]> {
        let first = &self.rows[0].q;
        let mut range: Vec<_> = first.iter().map(|q| [*q, *q]).collect();
        for row in &self.rows {
            for (range, q) in range.iter_mut().zip(&row.q) {
                *range = [range[0].min(*q), range[1].max(*q)];
            }
        }
        range
    }
}
