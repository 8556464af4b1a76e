use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use truearm::JointKind;

use super::Robot;
use crate::error::{Error, Place, Result};

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

/// Where each known column stands.
struct Columns {
    q: Vec<usize>,
    point: [usize; 3],
    optional: Optional,
    directions: Vec<Option<usize>>,
    orientation: Option<[usize; 4]>,
    extra: Vec<usize>,
}

#[derive(Default)]
struct Optional {
    time: Option<usize>,
    temperature: Option<usize>,
    payload: Option<usize>,
    order: Option<usize>,
    sigma: Option<usize>,
    series: Option<usize>,
    station: Option<usize>,
    marker: Option<usize>,
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
        let columns = Columns::find(path, &names, robot)?;
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
        data.poses = number_poses(&mut data.rows, robot);
        data.remark(robot);
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

/// One row being read.
struct Cells<'a> {
    path: &'a Path,
    line: usize,
    names: &'a [String],
    record: &'a csv::StringRecord,
}

impl Cells<'_> {
    fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or("")
    }

    fn fail(&self, column: usize, message: String, help: &str) -> Error {
        Error::file(self.path, Place::field(self.line, &self.names[column]), message, help)
    }

    /// A number, or `None` for an empty cell.
    fn optional(&self, column: Option<usize>) -> Result<Option<f64>> {
        let Some(column) = column else { return Ok(None) };
        let text = self.text(column);
        if text.is_empty() {
            return Ok(None);
        }
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            Ok(_) => Err(self.fail(
                column,
                format!("{text} is not a finite number"),
                "delete the row or measure it again",
            )),
            Err(_) => Err(self.fail(
                column,
                format!("\"{text}\" is not a number"),
                "write numbers with a decimal point",
            )),
        }
    }

    fn number(&self, column: usize) -> Result<f64> {
        self.optional(Some(column))?.ok_or_else(|| {
            self.fail(column, "empty cell".to_owned(), "fill it in or delete the row")
        })
    }
}

/// Index of a label in a growing list.
fn label(list: &mut Vec<String>, text: &str) -> usize {
    list.iter().position(|l| l == text).unwrap_or_else(|| {
        list.push(text.to_owned());
        list.len() - 1
    })
}

impl Columns {
    fn find(path: &Path, names: &[String], robot: &Robot) -> Result<Self> {
        let header = |message: String, help: &str| Error::file(path, Place::line(1), message, help);
        if names.iter().all(|n| n.is_empty()) {
            return Err(Error::file(
                path,
                Place::default(),
                "the file is empty",
                "it needs a header line and rows",
            ));
        }
        if names.len() == 1 && names[0].contains(';') {
            return Err(header(
                "cells are separated by `;`".into(),
                "separate them by commas, with decimal points",
            ));
        }
        for (i, name) in names.iter().enumerate() {
            if names[..i].contains(name) {
                return Err(header(
                    format!("column {name} stands there twice"),
                    "rename or delete one",
                ));
            }
        }
        let mut known = vec![false; names.len()];
        let mut take = |name: &str| {
            let found = names.iter().position(|n| n == name);
            if let Some(i) = found {
                known[i] = true;
            }
            found
        };
        let n = robot.joints.len();
        let mut q = Vec::new();
        for (j, joint) in robot.joints.iter().enumerate() {
            let name = match joint.link.kind {
                JointKind::Revolute => format!("q{}_deg", j + 1),
                JointKind::Prismatic => format!("q{}_mm", j + 1),
            };
            q.push(take(&name).ok_or_else(|| {
                let kind = joint.link.kind;
                header(
                    format!("missing column {name}"),
                    &format!(
                        "joint {} of {} is {kind:?} and the robot has {n} joints",
                        j + 1,
                        robot.path.display()
                    ),
                )
            })?);
        }
        for extra in [format!("q{}_deg", n + 1), format!("q{}_mm", n + 1)] {
            if names.contains(&extra) {
                return Err(header(
                    format!("column {extra}, but {} has {n} joints", robot.path.display()),
                    "use the robot file of this arm, or delete the column",
                ));
            }
        }
        let mut point = [0; 3];
        for (slot, name) in point.iter_mut().zip(["x_mm", "y_mm", "z_mm"]) {
            *slot = take(name).ok_or_else(|| {
                header(
                    format!("missing column {name}"),
                    "the measured point needs x_mm, y_mm, z_mm",
                )
            })?;
        }
        let quaternion = ["qx", "qy", "qz", "qw"].map(&mut take);
        let orientation = match quaternion {
            [Some(x), Some(y), Some(z), Some(w)] => Some([x, y, z, w]),
            [None, None, None, None] => None,
            _ => {
                return Err(header(
                    "orientation needs all of qx, qy, qz, qw".into(),
                    "add the missing ones or delete the others",
                ));
            }
        };
        let directions = (1..=n).map(|j| take(&format!("dir{j}"))).collect();
        let optional = Optional {
            time: take("time_s"),
            temperature: take("temperature_c"),
            payload: take("payload_kg"),
            order: take("order"),
            sigma: take("sigma_mm"),
            series: take("series"),
            station: take("station"),
            marker: take("marker"),
        };
        let extra = (0..names.len()).filter(|i| !known[*i]).collect();
        Ok(Self { q, point, optional, directions, orientation, extra })
    }

    fn row(
        &self,
        cells: &Cells,
        robot: &Robot,
        stations: &mut Vec<String>,
        markers: &mut Vec<String>,
    ) -> Result<Row> {
        let mut q = Vec::with_capacity(self.q.len());
        for (column, joint) in self.q.iter().zip(&robot.joints) {
            let value = cells.number(*column)?;
            q.push(match joint.link.kind {
                JointKind::Revolute if value.abs() > 1e5 => {
                    return Err(cells.fail(
                        *column,
                        format!("{value} degrees"),
                        "give the joint angle in degrees",
                    ));
                }
                JointKind::Revolute => value.to_radians(),
                JointKind::Prismatic => value * 1e-3,
            });
        }
        let mut point = Vector3::zeros();
        for (i, column) in self.point.iter().enumerate() {
            point[i] = cells.number(*column)? * 1e-3;
            if point[i].abs() > 1e3 {
                return Err(cells.fail(
                    *column,
                    format!("{} m away", point[i]),
                    "give the point in mm",
                ));
            }
        }
        let o = &self.optional;
        let sigma = match cells.optional(o.sigma)? {
            Some(mm) if mm > 0.0 => mm * 1e-3,
            Some(mm) => {
                let column = o.sigma.unwrap_or(0);
                return Err(cells.fail(
                    column,
                    format!("sigma {mm}"),
                    "give one positive standard deviation in mm",
                ));
            }
            None => robot.sigma,
        };
        let mut directions = Vec::new();
        for column in &self.directions {
            directions.push(match cells.optional(*column)? {
                None => 0,
                Some(v) if [-1.0, 0.0, 1.0].contains(&v) => v as i8,
                Some(v) => {
                    let help = "+1 came to rest moving in +q, -1 in -q, 0 or empty unknown";
                    return Err(cells.fail(column.unwrap_or(0), format!("direction {v}"), help));
                }
            });
        }
        let orientation = match self.orientation {
            None => None,
            Some(columns) => {
                let cell = |c: usize| cells.optional(Some(c));
                match (cell(columns[0])?, cell(columns[1])?, cell(columns[2])?, cell(columns[3])?) {
                    (Some(x), Some(y), Some(z), Some(w)) => {
                        let norm = (x * x + y * y + z * z + w * w).sqrt();
                        if (norm - 1.0).abs() > 1e-2 {
                            return Err(cells.fail(
                                columns[0],
                                format!("quaternion of length {norm:.3}"),
                                "give a unit quaternion qx, qy, qz, qw",
                            ));
                        }
                        Some([x, y, z, w].map(|v| v / norm))
                    }
                    _ => None,
                }
            }
        };
        let text = |column: Option<usize>| column.map_or("", |c| cells.text(c));
        Ok(Row {
            line: cells.line,
            q,
            point,
            sigma,
            station: label(stations, text(o.station)),
            marker: label(markers, text(o.marker)),
            pose: 0,
            series: Some(text(o.series)).filter(|s| !s.is_empty()).map(str::to_owned),
            time: cells.optional(o.time)?,
            temperature: cells.optional(o.temperature)?,
            payload: cells.optional(o.payload)?,
            order: cells.optional(o.order)?,
            orientation,
            directions,
            extra: self.extra.iter().map(|c| cells.text(*c).to_owned()).collect(),
        })
    }
}

/// Numbers the rows' poses in order of appearance; returns how many there are.
fn number_poses(rows: &mut [Row], robot: &Robot) -> usize {
    let same = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).zip(&robot.joints).all(|((a, b), joint)| {
            let limit = match joint.link.kind {
                JointKind::Revolute => SAME_ANGLE,
                JointKind::Prismatic => SAME_LENGTH,
            };
            (a - b).abs() <= limit
        })
    };
    // The first row of each pose, sorted by the first joint, so that only
    // near neighbours are compared.
    let mut firsts: Vec<(f64, usize)> = Vec::new();
    let mut poses = 0;
    for i in 0..rows.len() {
        let key = rows[i].q[0];
        let reach = SAME_ANGLE.max(SAME_LENGTH);
        let from = firsts.partition_point(|(k, _)| *k < key - reach);
        let near = firsts[from..].iter().take_while(|(k, _)| *k <= key + reach);
        let known = near.map(|(_, j)| *j).find(|j| same(&rows[*j].q, &rows[i].q));
        rows[i].pose = match known {
            Some(j) => rows[j].pose,
            None => {
                let at = firsts.partition_point(|(k, _)| *k < key);
                firsts.insert(at, (key, i));
                poses += 1;
                poses - 1
            }
        };
    }
    poses
}
