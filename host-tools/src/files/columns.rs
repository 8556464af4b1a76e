//! The header of a measurements.csv and how a row is read under it.

use std::path::Path;

use truearm::JointKind;

use super::measured::MeasuredColumns;
use crate::error::{Error, Place, Result};
use crate::model::{Robot, Row};

/// Where each known column stands.
pub(super) struct Columns {
    q: Vec<usize>,
    measured: MeasuredColumns,
    optional: Optional,
    directions: Vec<Option<usize>>,
    orientation: Option<[usize; 4]>,
    /// Columns without a meaning.
    pub extra: Vec<usize>,
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

/// One row being read.
pub(super) struct Cells<'a> {
    pub path: &'a Path,
    pub line: usize,
    pub names: &'a [String],
    pub record: &'a csv::StringRecord,
}

impl Cells<'_> {
    pub fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or("")
    }

    pub fn fail(&self, column: usize, message: String, help: &str) -> Error {
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

    pub fn number(&self, column: usize) -> Result<f64> {
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
    /// Finds the columns by name.
    /// `joints` is what the columns of the joints begin with; `None` if there are none.
    pub fn find(
        path: &Path,
        names: &[String],
        robot: &Robot,
        joints: Option<&str>,
    ) -> Result<Self> {
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
            let Some(prefix) = joints else { break };
            let name = match joint.link.kind {
                JointKind::Revolute => format!("{prefix}{}_deg", j + 1),
                JointKind::Prismatic => format!("{prefix}{}_mm", j + 1),
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
        let prefix = joints.unwrap_or("q");
        for extra in [format!("{prefix}{}_deg", n + 1), format!("{prefix}{}_mm", n + 1)] {
            if names.contains(&extra) {
                return Err(header(
                    format!("column {extra}, but {} has {n} joints", robot.path.display()),
                    "use the robot file of this arm, or delete the column",
                ));
            }
        }
        let measured = MeasuredColumns::find(&mut take, header)?;
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
        Ok(Self { q, measured, optional, directions, orientation, extra })
    }

    /// Reads a row; new station and marker labels join the lists.
    pub fn row(
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
        let (kind, measured) = self.measured.row(cells)?;
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
            kind,
            measured,
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
