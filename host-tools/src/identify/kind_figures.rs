//! What an identification has to say of a kind of measurement.

use schemars::JsonSchema;
use serde::Serialize;

/// One kind of measurement, or its lengths and angles each.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct KindFigures {
    /// Its name, as in the column `kind`.
    pub kind: &'static str,
    /// `mm`, `deg` or `px`.
    pub unit: &'static str,
    /// Rows of it.
    pub rows: usize,
    /// Root mean square of all components of a row together, nominal geometry.
    pub nominal_rms: Option<f64>,
    /// The same, identified.
    pub identified_rms: Option<f64>,
    /// The same, held out.
    pub cross_validated_rms: Option<f64>,
    /// Noise over what is stated: as `diagnose` found it; `identify` estimates it where
    /// there are several kinds, and has 1 of a single one.
    pub noise_scale: f64,
}
