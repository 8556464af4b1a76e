//! What a verification says.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;

use crate::statistics::Stats;

/// Mean and largest over poses, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct OverPoses {
    /// Poses it was computed of.
    pub poses: usize,
    /// Mean.
    pub mean_mm: f64,
    /// Largest.
    pub max_mm: f64,
}

/// What a tolerance says of the errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Conformity {
    /// The largest error and its uncertainty are within the tolerance.
    Pass,
    /// The largest error is beyond it by more than its uncertainty.
    Fail,
    /// The tolerance lies within the uncertainty of the largest error.
    NotProven,
}

/// A verified file.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Verification {
    /// The file.
    pub file: String,
    /// Rows.
    pub rows: usize,
    /// Distinct commanded poses and markers.
    pub poses: usize,
    /// Fewest and most repetitions of a pose.
    pub repeats: [usize; 2],
    /// `none` or `base`: what was fitted on this file.
    pub reregistered: &'static str,
    /// Errors of the rows.
    #[serde(flatten)]
    pub errors: Stats,
    /// Positioning accuracy, ISO 9283:1998 (7.2.1): distance of the barycentre
    /// of the attained points of a pose from the commanded point.
    pub accuracy: OverPoses,
    /// Positioning repeatability, ISO 9283:1998 (7.2.2): `mean l + 3 S_l`, l
    /// the distances of the attained points of a pose from their barycentre and
    /// `S_l^2 = sum (l - mean l)^2 / (n - 1)`; of poses with repetitions.
    pub repeatability: Option<OverPoses>,
    /// Of the error of one row, k = 2: measurement and frame.
    pub expanded_uncertainty_mm: f64,
    /// Joints commanded outside the range of the identification, from 1.
    pub joints_not_covered: Vec<usize>,
    /// Error of every row in the coordinates of the files, m.
    #[serde(skip)]
    pub row_errors: Vec<Vector3<f64>>,
    /// Errors that the model predicts without compensation; `None` where points
    /// were commanded.
    pub predicted_without_compensation: Option<Stats>,
}
