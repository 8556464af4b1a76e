//! The keys of a model.toml, in file units.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::files::covariance::CovarianceFile;
use crate::files::model_curves::CurveFile;
use crate::files::model_terms::{MeasurementTermFile, TermFile};
use crate::files::numbers::{exactly, if_given};
use crate::model::Provenance;

/// The file. The keys of robot.toml stand in it as they do there, so that a
/// model is a robot file with more in it.
#[derive(Serialize)]
pub(super) struct ModelFile {
    pub schema: &'static str,
    pub name: String,
    pub serial: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot_id: Option<String>,
    pub orientation_identified: bool,
    pub measurement_sigma_mm: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measurement_sigma_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<[f64; 3]>,
    pub reference_temperature_c: f64,
    pub unidentifiable: Vec<String>,
    pub provenance: Provenance,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gram: Option<GramFile>,
    pub frame: FrameFile,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base: Option<PlacementFile>,
    pub tool: PlacementFile,
    pub payload: PayloadFile,
    pub joints: Vec<JointFile>,
    pub corrections: Vec<CorrectionFile>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub terms: Vec<TermFile>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measurement_terms: Vec<MeasurementTermFile>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<CurveFile>,
    pub stations: Vec<StationFile>,
    pub markers: Vec<MarkerFile>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub instruments: Vec<InstrumentFile>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<LinkFile>,
}

/// What model.toml has beyond robot.toml.
#[derive(Deserialize)]
pub(super) struct ModelPart {
    pub schema: Spanned<String>,
    #[serde(default)]
    pub digest: String,
    pub robot_id: Option<Spanned<String>>,
    #[serde(default)]
    pub orientation_identified: bool,
    pub covariance: Option<Spanned<CovarianceFile>>,
    #[serde(default)]
    pub unidentifiable: Vec<String>,
    pub provenance: Provenance,
    pub gram: Option<Spanned<GramFile>>,
    pub frame: FrameFile,
    pub corrections: Vec<Spanned<CorrectionFile>>,
    #[serde(default)]
    pub terms: Vec<Spanned<TermFile>>,
    #[serde(default)]
    pub measurement_terms: Vec<Spanned<MeasurementTermFile>>,
    #[serde(default)]
    pub curves: Vec<Spanned<CurveFile>>,
    #[serde(default)]
    pub stations: Vec<Spanned<StationFile>>,
    pub markers: Vec<MarkerFile>,
    #[serde(default)]
    pub instruments: Vec<Spanned<InstrumentFile>>,
}

/// `[base]` or `[tool]`.
#[derive(Serialize)]
pub(super) struct PlacementFile {
    pub xyz_mm: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rpy_deg: Option<[f64; 3]>,
}

#[derive(Serialize)]
pub(super) struct PayloadFile {
    pub com_mm: [f64; 3],
}

#[derive(Serialize)]
pub(super) struct LinkFile {
    pub mass_kg: f64,
    pub com_mm: [f64; 3],
}

#[derive(Serialize)]
pub(super) struct JointFile {
    pub kind: &'static str,
    pub alpha_deg: f64,
    pub a_mm: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub d_mm: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub d_offset_mm: Option<f64>,
    pub theta_offset_deg: f64,
    pub beta_deg: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits_deg: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits_mm: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gear_ratio: Option<f64>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub tolerance: BTreeMap<&'static str, f64>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub expected: BTreeMap<&'static str, f64>,
}

/// Corrections to a joint and one standard deviation of each.
#[derive(Serialize, Deserialize)]
pub(super) struct CorrectionFile {
    pub joint: usize,
    pub alpha_deg: f64,
    pub a_mm: f64,
    pub theta_offset_deg: f64,
    pub d_mm: f64,
    pub beta_deg: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma: Option<SigmaFile>,
    #[serde(default, deserialize_with = "if_given", skip_serializing_if = "Option::is_none")]
    pub covered_deg: Option<[f64; 2]>,
    #[serde(default, deserialize_with = "if_given", skip_serializing_if = "Option::is_none")]
    pub covered_mm: Option<[f64; 2]>,
}

impl CorrectionFile {
    /// In the order of the parameters of a link.
    pub fn numbers(&self) -> [f64; 5] {
        [self.alpha_deg, self.a_mm, self.theta_offset_deg, self.d_mm, self.beta_deg]
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct SigmaFile {
    pub alpha_deg: f64,
    pub a_mm: f64,
    pub theta_offset_deg: f64,
    pub d_mm: f64,
    pub beta_deg: f64,
}

/// `[gram]`: how far an identification by parts has come.
#[derive(Serialize, Deserialize)]
pub(super) struct GramFile {
    pub stage: u32,
    pub settled: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_tolerances: Option<f64>,
    pub k: f64,
    pub weights: f64,
    pub flagged: usize,
    pub targets_mm: Vec<[f64; 3]>,
}

/// The small rigid transform taken out before packing.
#[derive(Serialize, Deserialize)]
pub(super) struct FrameFile {
    #[serde(deserialize_with = "exactly")]
    pub xyz_mm: [f64; 3],
    #[serde(deserialize_with = "exactly")]
    pub rotation_vector_deg: [f64; 3],
}

#[derive(Serialize, Deserialize)]
pub(super) struct StationFile {
    pub label: String,
    #[serde(deserialize_with = "exactly")]
    pub xyz_mm: [f64; 3],
    #[serde(deserialize_with = "exactly")]
    pub quaternion_xyzw: [f64; 4],
}

#[derive(Serialize, Deserialize)]
pub(super) struct MarkerFile {
    pub label: String,
    #[serde(deserialize_with = "exactly")]
    pub xyz_mm: [f64; 3],
    /// Whether some row measured where it is.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub measured: bool,
}

fn yes() -> bool {
    true
}

fn is_yes(value: &bool) -> bool {
    *value
}

/// What was measured with and on: its frame in the station's, or in the last
/// frame where it is mounted there; its numbers, radii in mm.
#[derive(Serialize, Deserialize)]
pub(super) struct InstrumentFile {
    pub form: String,
    pub label: String,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub on_flange: bool,
    #[serde(deserialize_with = "exactly")]
    pub xyz_mm: [f64; 3],
    #[serde(deserialize_with = "exactly")]
    pub quaternion_xyzw: [f64; 4],
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<f64>,
    /// A lower triangle, a line a column; SI.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub covariance: Vec<Vec<f64>>,
}
