//! What a verification says.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;

use super::kinds::KindVerified;
use super::moved::FrameMoved;
use crate::observations::Residual;
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

/// What the points of a file say.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct OfPoints {
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
    /// Errors that the model predicts without compensation; `None` where points
    /// were commanded.
    pub predicted_without_compensation: Option<Stats>,
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
    /// One rigid motion of the frame that explains nearly all of the errors, where there is
    /// one: `null` where the frame is as good as any, and where it was fitted.
    pub frame_moved: Option<FrameMoved>,
    /// What its points say; nothing where it has none.
    #[serde(flatten)]
    pub points: Option<OfPoints>,
    /// Kinds of measurements, each in its own unit.
    pub kinds: Vec<KindVerified>,
    /// Joints commanded outside the range of the identification, from 1.
    pub joints_not_covered: Vec<usize>,
    /// Error of every row that measured a point, in the coordinates of the files, m.
    #[serde(skip)]
    pub row_errors: Vec<Option<Vector3<f64>>>,
    /// Measured beyond what was commanded, of every row, SI.
    #[serde(skip)]
    pub residuals: Vec<Residual>,
    /// Remarks.
    #[serde(skip)]
    pub warnings: Vec<String>,
}

impl Verification {
    /// Whether it has more than points.
    #[must_use]
    pub fn has_others(&self) -> bool {
        self.points.is_none() || self.kinds.len() > 1
    }
}
