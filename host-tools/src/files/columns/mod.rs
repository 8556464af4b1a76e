//! The header of a measurements.csv and how a row is read under it.

mod cells;
mod header;
mod measured;
mod plausible;

use std::path::Path;

use truearm::JointKind;

use super::instruments::Gathered;
use super::source::Source;
use crate::error::{Error, Place, Result};
use crate::model::{Robot, Row};
use crate::units::{from_mm, joint_from_file};
#[cfg(feature = "parquet")]
pub(super) use cells::number;
pub(super) use cells::{Cells, Record};
pub(super) use header::Header;
use measured::{Measured, MeasuredColumns};

/// Standard deviations of a coordinate that an instrument may have, mm: none
/// knows a nanometre, and beyond the largest it says nothing of an arm.
pub(super) const SIGMAS: std::ops::RangeInclusive<f64> = 1e-6..=10.0;

/// A standard deviation as a file states it.
struct Sigma {
    unit: &'static str,
    /// No instrument is better or worse.
    range: std::ops::RangeInclusive<f64>,
    such_as: f64,
    to_si: fn(f64) -> f64,
}

const SIGMA_MM: Sigma =
    Sigma { unit: "mm", range: SIGMAS, such_as: USUAL_SIGMA_MM, to_si: from_mm };
const SIGMA_DEG: Sigma =
    Sigma { unit: "degrees", range: 1e-6..=10.0, such_as: 0.01, to_si: f64::to_radians };
const SIGMA_PX: Sigma = Sigma { unit: "px", range: 1e-4..=100.0, such_as: 0.1, to_si: |px| px };
/// Standard deviation of a measured coordinate that nothing is stated of, mm.
pub(crate) const USUAL_SIGMA_MM: f64 = 0.03;
/// Of an angle that nothing is stated of, rad.
pub(crate) const USUAL_SIGMA_ANGLE: f64 = 0.01 * std::f64::consts::PI / 180.0;
/// Of a pixel that nothing is stated of.
pub(crate) const USUAL_SIGMA_PX: f64 = 0.1;
/// Farther than any rail goes, mm.
const MOST_MM: f64 = 1e5;
/// More degrees no encoder reads.
const MOST_DEGREES: f64 = 1e5;

/// Where each known column stands.
pub(super) struct Columns {
    q: Vec<usize>,
    /// `None` where nothing was measured.
    measured: Option<MeasuredColumns>,
    optional: Optional,
    directions: Vec<Option<usize>>,
    torques: Option<Vec<usize>>,
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
    sigma_deg: Option<usize>,
    sigma_px: Option<usize>,
    series: Option<usize>,
    station: Option<usize>,
    marker: Option<usize>,
}

/// Labels in order of appearance.
#[derive(Default)]
pub(super) struct Labels {
    pub stations: Vec<String>,
    pub markers: Vec<String>,
    /// What rows refer to.
    pub book: Gathered,
    /// What joins each row to another.
    pub pairs: Vec<Option<String>>,
}

impl Labels {
    /// Labels that differ in case only would be two stations.
    pub fn refuse_twins(&self, path: &Path) -> Result<()> {
        refuse_twins(path, &self.stations, &self.markers)
    }
}

/// The same of the labels that files have together.
pub(super) fn refuse_twins(path: &Path, stations: &[String], markers: &[String]) -> Result<()> {
    for (what, labels) in [("station", stations), ("marker", markers)] {
        for (i, label) in labels.iter().enumerate() {
            let like = |l: &&String| l.to_lowercase() == label.to_lowercase();
            let Some(twin) = labels[..i].iter().find(like) else { continue };
            let help = format!("write a {what} alike everywhere, or give two other names");
            let message = format!("{what} \"{twin}\" and \"{label}\" differ in case only");
            return Err(Error::file(path, Place::default(), message, help));
        }
    }
    Ok(())
}

/// Index of a label in a growing list.
pub(super) fn label(list: &mut Vec<String>, text: &str) -> usize {
    list.iter().position(|l| l == text).unwrap_or_else(|| {
        list.push(text.to_owned());
        list.len() - 1
    })
}

impl Columns {
    /// Finds the columns by name. `joints` is what the columns of the joints
    /// begin with; `None` if there are none. Where nothing was `measured`, its
    /// columns are columns without a meaning.
    pub fn find(
        source: Source,
        names: &[String],
        robot: &Robot,
        (joints, measured): (Option<&str>, bool),
    ) -> Result<Self> {
        let mut header = Header::new(source, names)?;
        let q = header.joints(robot, joints)?;
        let sigma_deg = if measured { header.take("sigma_deg") } else { None };
        let with_turns = sigma_deg.is_some() || robot.sigma_angle.is_some();
        let find = |header: &mut Header| MeasuredColumns::find(header, with_turns);
        let measured = measured.then(|| find(&mut header)).transpose()?;
        let orientation = header.orientation()?;
        let directions =
            (1..=robot.joints.len()).map(|j| header.take(&format!("dir{j}"))).collect();
        let torques = header.torques(robot)?;
        let optional = Optional {
            time: header.take("time_s"),
            temperature: header.take("temperature_c"),
            payload: header.take("payload_kg"),
            order: header.take("order"),
            sigma: header.take("sigma_mm"),
            sigma_deg,
            sigma_px: measured.as_ref().and_then(|_| header.take("sigma_px")),
            series: header.take("series"),
            station: header.take("station"),
            marker: header.take("marker"),
        };
        let extra = header.unknown();
        Ok(Self { q, measured, optional, directions, torques, orientation, extra })
    }

    /// Whether rows with an orientation are poses.
    pub fn of_poses(&self) -> bool {
        self.orientation.is_none() || self.measured.as_ref().is_none_or(|m| m.of_poses())
    }

    /// Reads a row; new station and marker labels join the lists.
    pub fn row(&self, cells: &Cells, robot: &Robot, labels: &mut Labels) -> Result<Row> {
        let o = &self.optional;
        let text = |column: Option<usize>| column.map_or("", |c| cells.text(c));
        let orientation = self.orientation(cells)?;
        let (marker, book) = (text(o.marker), &mut labels.book);
        let measured =
            self.measured.as_ref().map(|all| all.row(cells, marker, book)).transpose()?;
        let nothing = || Measured { target: marker.to_owned(), ..Measured::default() };
        let Measured { kind, values: measured, refers, target, pair } =
            measured.unwrap_or_else(nothing);
        labels.pairs.push(pair);
        let angle = robot.sigma_angle.unwrap_or(USUAL_SIGMA_ANGLE);
        Ok(Row {
            line: cells.line,
            q: self.joints(cells, robot)?,
            kind,
            measured,
            sigma: self.sigma(cells, o.sigma, SIGMA_MM)?.unwrap_or(robot.sigma),
            sigma_angle: self.sigma(cells, o.sigma_deg, SIGMA_DEG)?.unwrap_or(angle),
            sigma_px: self.sigma(cells, o.sigma_px, SIGMA_PX)?.unwrap_or(USUAL_SIGMA_PX),
            refers,
            partner: None,
            station: label(&mut labels.stations, text(o.station)),
            marker: label(&mut labels.markers, &target),
            pose: 0,
            series: Some(text(o.series)).filter(|s| !s.is_empty()).map(str::to_owned),
            time: plausible::time(cells, o.time)?,
            temperature: plausible::temperature(cells, o.temperature)?,
            warming: None,
            payload: plausible::payload(cells, o.payload)?,
            run: 0,
            order: plausible::order(cells, o.order)?,
            orientation,
            directions: self.directions(cells)?,
            torques: plausible::torques(cells, self.torques.as_deref())?,
        })
    }

    fn joints(&self, cells: &Cells, robot: &Robot) -> Result<Vec<f64>> {
        let value = |(column, joint): (&usize, &crate::model::Joint)| {
            let (value, kind) = (cells.number(*column)?, joint.link.kind);
            if kind == JointKind::Revolute && value.abs() > MOST_DEGREES {
                let help = "give the joint angle in degrees";
                return Err(cells.fail(*column, format!("{value} degrees"), help));
            }
            if kind == JointKind::Prismatic && value.abs() > MOST_MM {
                let help = "give the joint value in mm";
                return Err(cells.fail(*column, format!("{value} mm"), help));
            }
            Ok(joint_from_file(kind, value))
        };
        self.q.iter().zip(&robot.joints).map(value).collect()
    }

    fn sigma(&self, cells: &Cells, column: Option<usize>, of: Sigma) -> Result<Option<f64>> {
        let Some(column) = column else { return Ok(None) };
        match cells.optional(Some(column))? {
            Some(sigma) if !of.range.contains(&sigma) => {
                let help = format!(
                    "give one positive standard deviation in {}, {:?} to {}, such as {}",
                    of.unit,
                    of.range.start(),
                    of.range.end(),
                    of.such_as
                );
                Err(cells.fail(column, format!("sigma {sigma:?}"), &help))
            }
            sigma => Ok(sigma.map(of.to_si)),
        }
    }

    fn directions(&self, cells: &Cells) -> Result<Vec<i8>> {
        let side = |column: &Option<usize>| match (cells.optional(*column)?, column) {
            (Some(v), _) if [-1.0, 0.0, 1.0].contains(&v) => Ok(v as i8),
            (Some(v), Some(column)) => {
                let help = "+1 came to rest moving in +q, -1 in -q, 0 or empty unknown";
                Err(cells.fail(*column, format!("direction {v}"), help))
            }
            _ => Ok(0),
        };
        self.directions.iter().map(side).collect()
    }

    fn orientation(&self, cells: &Cells) -> Result<Option<[f64; 4]>> {
        let Some(columns) = self.orientation else { return Ok(None) };
        // A row without any is of a point; a part of one is a slip.
        if columns.iter().all(|column| cells.text(*column).is_empty()) {
            return Ok(None);
        }
        let mut quaternion = [0.0; 4];
        for (slot, column) in quaternion.iter_mut().zip(columns) {
            *slot = cells.number(column)?;
        }
        let norm = quaternion.iter().map(|v| v * v).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > 1e-2 {
            let help = "give a unit quaternion qx, qy, qz, qw";
            return Err(cells.fail(columns[0], format!("quaternion of length {norm:.3}"), help));
        }
        Ok(Some(quaternion.map(|v| v / norm)))
    }
}
