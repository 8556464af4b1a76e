//! What an identification has to say in figures.

use schemars::JsonSchema;
use serde::Serialize;

use super::kind_figures::KindFigures;
use super::{LCurvePoint, LambdaChoice};
use crate::identify::certainty::error_bars::Uncertainty;
use crate::statistics::Stats;

/// A flagged row of the measurements.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FlaggedRow {
    /// Data row, counted from 1 through all files; where rows were drawn, through those.
    pub row: usize,
    /// The file that it stands in...
    pub file: String,
    /// ...and the line.
    pub line: usize,
    /// Which components are wrong: of a point x, y, z.
    pub coordinates: Vec<&'static str>,
    /// Measured minus predicted by the other rows, mm; degrees of components that
    /// are angles, px of those in an image.
    pub residual_mm: Vec<f64>,
}

/// A number, or `"> 1e15"` where rounding hides it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Condition {
    /// As computed.
    Number(f64),
    /// At rounding level.
    Beyond(&'static str),
}

impl From<f64> for Condition {
    fn from(value: f64) -> Self {
        if value > 1e15 { Self::Beyond("> 1e15") } else { Self::Number(value) }
    }
}

/// The blocks once more, flagged rows included.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct AllRows {
    /// Nominal geometry.
    pub nominal: Option<Stats>,
    /// Identified model.
    pub identified: Option<Stats>,
    /// Held out.
    pub cross_validated: Option<Stats>,
}

/// Of rows that were read in pieces: how many of them figures of distances and of single rows are
/// of, and what all of them say.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Drawn {
    /// Rows drawn by chance, the same in every run.
    pub rows: usize,
    /// How often all rows were read to sum them.
    pub rounds: u32,
    /// Rows of all that are gross errors and do not count.
    pub flagged: usize,
    /// Rows of all that say what an earlier one says to the last digit, and do not count.
    pub twice: usize,
    /// Root mean square of the distances of all others, each weighed by 1/sigma^2, mm.
    pub rms_mm: f64,
    /// The same of poses held out; none where a tenth of the poses is too much to miss.
    pub cross_validated_rms_mm: Option<f64>,
}

/// The figures of an identified arm.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Figures {
    /// The robot.
    pub robot: String,
    /// The measurements.
    pub data: String,
    /// Data rows.
    pub rows: usize,
    /// Distinct poses.
    pub poses: usize,
    /// Tracker stations.
    pub stations: Vec<String>,
    /// Markers.
    pub markers: Vec<String>,
    /// Free parameters.
    pub parameters: usize,
    /// Independent directions among them.
    pub rank: usize,
    /// Largest over smallest singular value of the independent directions,
    /// columns in tolerances.
    pub condition_number: f64,
    /// Eq. 24, in metres and radians, redundancy included.
    pub condition_number_raw: Condition,
    /// The regularisation parameter.
    pub lambda: f64,
    /// How it was chosen.
    pub lambda_rule: &'static str,
    /// What lambda weighs: `prior` or `printed`.
    pub lambda_scaling: &'static str,
    /// What the rules say at the solution.
    pub lambda_choice: Option<LambdaChoice>,
    /// What every lambda leaves and asks for, least lambda first; the last point is
    /// the chosen one.
    pub l_curve: Vec<LCurvePoint>,
    /// Norm of the corrections, in tolerances.
    pub correction_norm: f64,
    /// The largest of them, in tolerances.
    pub largest_correction: f64,
    /// Residual scale over the standard deviation, the stated one or in `diagnose` the one
    /// that was found; well above 1 means structure that the model lacks.
    pub residual_over_sigma: f64,
    /// Nominal geometry, base and tool registered.
    pub nominal: Option<Stats>,
    /// Identified model on the rows it was fitted to.
    pub identified: Option<Stats>,
    /// Poses held out in folds; flags and lambda decided anew in each.
    pub cross_validated: Option<Stats>,
    /// `leave-one-out` or `5 random folds of poses`.
    pub cross_validation: String,
    /// Folds of poses measured one after another; needs `order` or `time_s`.
    pub cross_validated_blocked: Option<Stats>,
    /// Rows that no fold could judge: too few others at their station or marker.
    pub rows_not_cross_validated: usize,
    /// The blocks with flagged rows included.
    pub all_rows: AllRows,
    /// Where rows were read in pieces: distances, flagged rows and pictures are those of some.
    pub drawn: Option<Drawn>,
    /// Flagged data rows, counted from 1 as in `outliers`.
    pub outlier_rows: Vec<usize>,
    /// What is wrong in them.
    pub outliers: Vec<FlaggedRow>,
    /// Combinations of parameters that move no measured point.
    pub unidentifiable: Vec<String>,
    /// Directions about which the data say less than the tolerances.
    pub weakly_determined: Vec<String>,
    /// 95 % error bars of parameters and of the predicted tool point.
    pub uncertainty: Uncertainty,
    /// Kinds of measurements, each in its own units.
    pub kinds: Vec<KindFigures>,
    /// What the kinds of the file leave open, in words, where it has no points.
    pub left_open: Vec<String>,
    /// Whether the data determine how the last frame is turned.
    pub orientation_identified: bool,
    /// Remarks.
    pub warnings: Vec<String>,
}
