//! The keys of a robot.toml, in file units.

use serde::Deserialize;
use toml::Spanned;

use crate::files::numbers::Numbers;

#[derive(Deserialize)]
pub(super) struct RobotFile {
    /// A model.toml names its schema.
    pub schema: Option<String>,
    pub name: Option<String>,
    pub serial: Option<String>,
    pub measurement_sigma_mm: Option<Spanned<f64>>,
    pub measurement_sigma_deg: Option<Spanned<f64>>,
    #[serde(rename = "repeatability_mm")]
    _repeatability_mm: Option<f64>,
    pub gravity_m_s2: Option<Spanned<Numbers<3>>>,
    pub reference_temperature_c: Option<Spanned<f64>>,
    #[serde(default)]
    pub joints: Vec<Spanned<JointFile>>,
    pub base: Option<PlacementFile>,
    pub tool: Option<PlacementFile>,
    #[serde(default)]
    pub links: Vec<LinkFile>,
    pub payload: Option<PayloadFile>,
}

#[derive(Deserialize)]
pub(super) struct JointFile {
    pub kind: Option<Spanned<String>>,
    pub alpha_deg: Spanned<f64>,
    pub a_mm: Spanned<f64>,
    pub d_mm: Option<Spanned<f64>>,
    pub d_offset_mm: Option<Spanned<f64>>,
    pub theta_offset_deg: Spanned<f64>,
    pub beta_deg: Option<Spanned<f64>>,
    pub limits_deg: Option<Spanned<Numbers<2>>>,
    pub limits_mm: Option<Spanned<Numbers<2>>>,
    pub gear_ratio: Option<Spanned<f64>>,
    pub tolerance: Option<ParametersFile>,
    pub expected: Option<ParametersFile>,
}

/// `[base]` or `[tool]`.
#[derive(Deserialize)]
pub(super) struct PlacementFile {
    pub xyz_mm: Option<Spanned<Numbers<3>>>,
    pub rpy_deg: Option<Spanned<Numbers<3>>>,
}

#[derive(Deserialize)]
pub(super) struct LinkFile {
    pub mass_kg: Spanned<f64>,
    pub com_mm: Spanned<Numbers<3>>,
}

#[derive(Deserialize)]
pub(super) struct PayloadFile {
    pub com_mm: Spanned<Numbers<3>>,
}

/// A number a parameter, under the names that nominal ones have.
#[derive(Deserialize)]
pub(super) struct ParametersFile {
    pub alpha_deg: Option<Spanned<f64>>,
    pub a_mm: Option<Spanned<f64>>,
    pub theta_offset_deg: Option<Spanned<f64>>,
    pub d_mm: Option<Spanned<f64>>,
    pub d_offset_mm: Option<Spanned<f64>>,
    pub beta_deg: Option<Spanned<f64>>,
}
