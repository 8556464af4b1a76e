use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use truearm::{MdhParameters, Pose};

use super::robot::Robot;
use crate::error::{Error, ErrorKind, Result, listed};
use crate::model::{ErrorCurve, GramState, Instrument, Measurements, ModelTerm, Row};
use crate::units::duration;

/// An identified arm: what `identify` writes, `evaluate` scores, `pack` flashes.
/// SI units.
#[derive(Debug, Clone)]
pub struct Model {
    /// The nominal arm.
    pub robot: Robot,
    /// Identified corrections of each link.
    pub corrections: Vec<MdhParameters<f64>>,
    /// One standard deviation of each correction; empty if unknown.
    pub uncertainties: Vec<MdhParameters<f64>>,
    /// Joint ranges of the identification, rad or m; `None` if unknown.
    pub covered: Vec<Option<[f64; 2]>>,
    /// Terms beyond geometry.
    pub terms: Vec<ModelTerm>,
    /// Smooth errors of joint angles, one a joint at most.
    pub curves: Vec<ErrorCurve>,
    /// Robot base in the frame of each tracker station.
    pub stations: Vec<(String, Pose<f64>)>,
    /// Each marker in the flange frame, m.
    pub markers: Vec<(String, Vector3<f64>)>,
    /// Labels of those of them whose point no row measured: of an inclinometer, of a ray.
    pub not_measured: Vec<String>,
    /// What was measured with and on, found with the arm.
    pub instruments: Vec<Instrument>,
    /// Carries identified tool points onto nominal ones: translation, m.
    pub frame_translation: Vector3<f64>,
    /// The same: rotation vector, rad.
    pub frame_rotation: Vector3<f64>,
    /// Where the model came from.
    pub provenance: Provenance,
    /// Directions the data could not determine, in words.
    pub unidentifiable: Vec<String>,
    /// Whether the data determined how the flange is turned.
    pub orientation_identified: bool,
    /// Id of the robot where name and serial are not known, only their hash.
    pub robot_id: Option<u64>,
    /// Factor of the covariance of the arm's parameters as a blob holds it.
    pub covariance: Option<Vec<f32>>,
    /// Whether the file was changed since it was written, in what the arm's
    /// accuracy and covariance depend on: they are then not this model's.
    pub changed: bool,
    /// Where it is a state of an identification by parts.
    pub gram: Option<GramState>,
}

/// Where a model came from.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of truearm.
    pub version: String,
    /// UTC, RFC 3339.
    pub created: String,
    /// Sequence number, where it is not the creation time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<u32>,
    /// The measurements.
    pub data: String,
    /// Rows of the measurements.
    pub rows: usize,
    /// Distinct poses.
    pub poses: usize,
    /// Rows left out as gross errors, counted from 1.
    pub outlier_rows: Vec<usize>,
    /// The regularisation parameter.
    pub lambda: f64,
    /// How it was chosen.
    pub lambda_rule: String,
    /// RMS error with nominal geometry, mm.
    pub nominal_rms_mm: f64,
    /// Cross-validated RMS error, mm.
    pub cross_validated_rms_mm: f64,
    /// How well the predicted tool point is known, half width of its 95 % interval, RMS over
    /// the poses, mm; where that was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool_point_mm: Option<f64>,
}

/// Half width of the 95 % interval of the tool point beyond which nothing is made of a model,
/// mm. An arm of which nothing but its tolerances of 1 mm and 1 mrad is known has 2 to 4.
const UNTOLD: f64 = 20.0;

impl Model {
    /// Whether its springs and gaps follow torques that are read: it has no masses.
    #[must_use]
    pub fn reads_torques(&self) -> bool {
        let needed = |t: &ModelTerm| matches!(t, ModelTerm::Arm(term) if term.needs_torque());
        !self.robot.is_weighed() && self.terms.iter().any(needed)
    }

    /// Whether a row's gravity torques are known where the model's springs and gaps
    /// need them: from masses, or as every row has read them.
    ///
    /// # Errors
    /// [`ErrorKind::NoTorques`], naming the file of the rows.
    pub fn loaded(&self, data: &Measurements) -> Result<()> {
        let needed = |t: &ModelTerm| matches!(t, ModelTerm::Arm(term) if term.needs_load());
        if self.robot.is_weighed() || data.has_torques() || !self.terms.iter().any(needed) {
            return Ok(());
        }
        Err(Error::data(
            ErrorKind::NoTorques,
            format!(
                "{}: the model's springs were identified from torques that were read, and these rows \
                 have none",
                data.path.display()
            ),
            "give every row the columns torque1_nm.., or the model's robot gravity and [[links]] \
             and identify anew",
        ))
    }

    /// Whether rows say when their temperatures were read, where the arm follows them late.
    /// Of a temperature that never changes that need not be known.
    ///
    /// # Errors
    /// [`ErrorKind::NoTimes`], naming the file of the rows and the column.
    pub fn timed(&self, data: &Measurements) -> Result<()> {
        let Some(late) = self.terms.iter().find_map(ModelTerm::time_constant) else {
            return Ok(());
        };
        let mut read = data.rows.iter().filter_map(|row| row.temperature);
        let changes = read.next().is_some_and(|first| read.any(|other| other != first));
        let untimed = |row: &&Row| row.temperature.is_some() && row.warming.is_none();
        let Some(row) = data.rows.iter().find(untimed).filter(|_| changes) else { return Ok(()) };
        Err(Error::data(
            ErrorKind::NoTimes,
            format!(
                "{}: line {}: no time_s, and this arm grows with the temperature as it was: it follows \
                 temperature_c with a time constant of {}",
                data.path.display(),
                row.line,
                duration(late)
            ),
            "give every row with a temperature a time in the column time_s; or write the one \
             temperature at which the arm has long been in all of them",
        ))
    }

    /// An arm as its drawing has it: no corrections, stations or markers.
    #[must_use]
    pub fn nominal(robot: Robot) -> Self {
        let joints = robot.joints.len();
        Self {
            corrections: vec![MdhParameters::default(); joints],
            uncertainties: Vec::new(),
            covered: vec![None; joints],
            terms: Vec::new(),
            curves: Vec::new(),
            stations: Vec::new(),
            markers: Vec::new(),
            not_measured: Vec::new(),
            instruments: Vec::new(),
            frame_translation: Vector3::zeros(),
            frame_rotation: Vector3::zeros(),
            provenance: Provenance::default(),
            unidentifiable: Vec::new(),
            orientation_identified: false,
            robot_id: None,
            covariance: None,
            changed: false,
            gram: None,
            robot,
        }
    }

    /// Markers whose point some row measured.
    pub fn measured(&self) -> impl Iterator<Item = &(String, Vector3<f64>)> {
        self.markers.iter().filter(|(label, _)| !self.not_measured.contains(label))
    }

    /// Which of some labels stands for the tool where nothing else is said: the empty one,
    /// or else the first by name, whatever the order of the rows.
    pub fn first_of<'a>(labels: impl Iterator<Item = &'a String>) -> Option<&'a String> {
        labels.min()
    }

    /// The marker that stands for the tool where nothing else is said; `None` where no row
    /// measured where any is.
    #[must_use]
    pub fn tool_marker(&self) -> Option<&(String, Vector3<f64>)> {
        let label = Self::first_of(self.measured().map(|(label, _)| label))?;
        self.markers.iter().find(|(own, _)| own == label)
    }

    /// Whether it is clear which marker stands for the tool.
    ///
    /// # Errors
    /// Points of several were measured, and none is without a label.
    pub fn clear_tool(&self) -> Result<()> {
        let labels: Vec<String> =
            self.measured().map(|(label, _)| format!("\"{label}\"")).collect();
        if labels.len() > 1 && self.tool_marker().is_some_and(|(label, _)| !label.is_empty()) {
            return Err(Error::usage(
                format!("the points of {} markers were measured", labels.len()),
                format!("say which of them is the tool with --marker: {}", labels.join(", ")),
            ));
        }
        Ok(())
    }

    /// Whether the tool is known better than it was before anything was measured.
    ///
    /// # Errors
    /// The measurements leave it open by more than 20 mm (95 %).
    pub fn told_tool(&self) -> Result<()> {
        let known = self.provenance.tool_point_mm.unwrap_or(0.0);
        if known <= UNTOLD {
            return Ok(());
        }
        Err(Error::data(
            ErrorKind::Refused,
            format!(
                "{}: the measurements leave the tool point unknown to +-{known:.0} mm (95 %), more \
                 than no calibration would: {}",
                self.robot.path.display(),
                self.unidentifiable.first().map_or("poses too alike", String::as_str)
            ),
            "turn the wrist about every axis while measuring, add rows that see the tool from \
             other sides, or a kind that fixes what is open (docs/instruments.md)",
        ))
    }

    /// Where the tool is in the last frame, m: its marker, or else as robot.toml has it.
    #[must_use]
    pub fn tool(&self) -> Vector3<f64> {
        self.tool_marker().map_or(self.robot.tool, |(_, point)| *point)
    }

    /// The same model with this marker for the tool; without its covariance where that is
    /// of another.
    ///
    /// # Errors
    /// A marker that the model does not have, or whose point no row measured.
    pub fn with_tool(mut self, marker: &str) -> Result<Self> {
        let known: Vec<String> = self.measured().map(|(label, _)| label.clone()).collect();
        if !known.iter().any(|label| label == marker) {
            let why = match self.not_measured.iter().any(|label| label == marker) {
                true => "no row measured where it is",
                false => "the model does not have it",
            };
            let labelled = self.measured().any(|(label, _)| !label.is_empty());
            let help = match labelled {
                // The one of a file without labels has none.
                false => "leave it out: no marker with a label was measured".to_owned(),
                true => format!("markers whose place was measured: {}", listed(&known)),
            };
            return Err(Error::usage(format!("--marker {marker}: {why}"), help));
        }
        if self.tool_marker().is_none_or(|(label, _)| label != marker) {
            self.covariance = None;
        }
        self.markers.retain(|(label, _)| label == marker);
        Ok(self)
    }

    /// The identified links: nominal plus corrections.
    #[must_use]
    pub fn links(&self) -> Vec<truearm::Link<f64>> {
        let nominal = self.robot.nominal();
        nominal.iter().zip(&self.corrections).map(|(l, c)| l.corrected(c)).collect()
    }
}
