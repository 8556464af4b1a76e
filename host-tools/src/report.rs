//! `report.json`: one schema for all verbs.

use serde::Serialize;

use crate::identify::LambdaChoice;
use crate::identify::error_bars::Uncertainty;
use crate::identify::robust::median;
use crate::observations::Miss;

/// Distances between measured and predicted points, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stats {
    /// Mean.
    pub mean_mm: f64,
    /// Root mean square.
    pub rms_mm: f64,
    /// Largest.
    pub max_mm: f64,
    /// Sample standard deviation.
    pub sd_mm: f64,
}

impl Stats {
    /// Of how far off things are; `None` of none.
    #[must_use]
    pub fn of(residuals: &[impl Miss]) -> Option<Self> {
        let d: Vec<f64> = residuals.iter().map(|r| r.miss() * 1e3).collect();
        let n = d.len() as f64;
        if d.is_empty() {
            return None;
        }
        let mean = d.iter().sum::<f64>() / n;
        let square = |about: f64| d.iter().map(|x| (x - about).powi(2)).sum::<f64>();
        Some(Self {
            mean_mm: mean,
            rms_mm: (square(0.0) / n).sqrt(),
            max_mm: d.iter().copied().fold(0.0, f64::max),
            sd_mm: (square(mean) / (n - 1.0).max(1.0)).sqrt(),
        })
    }
}

/// A flagged row of the measurements.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlaggedRow {
    /// Data row, counted from 1.
    pub row: usize,
    /// Which components are wrong: of a point x, y, z.
    pub coordinates: Vec<&'static str>,
    /// Measured minus predicted by the other rows, mm.
    pub residual_mm: Vec<f64>,
}

/// A number, or `"> 1e15"` where rounding hides it.
#[derive(Debug, Clone, PartialEq, Serialize)]
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

/// A file of poses that were not fitted, scored.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Validation {
    /// The file.
    pub file: String,
    /// Rows scored.
    pub rows: usize,
    /// `none`, `base` or `base+tool`: what was fitted on this file.
    pub reregistered: &'static str,
    /// Rows left out on their own evidence (beyond 10 robust standard
    /// deviations, at most 1 % of the rows), counted from 1.
    pub left_out: Vec<usize>,
    /// Errors of the rows.
    #[serde(flatten)]
    pub stats: Stats,
    /// The same with the rows left out.
    pub all_rows: Stats,
    /// RMS with the nominal geometry in the same frames (its own registration
    /// where the file was registered anew), mm.
    pub nominal_rms_mm: f64,
    /// RMS if a base were fitted on this file; `null` where it was.
    pub base_refitted_rms_mm: Option<f64>,
    /// Joints with values outside the identified range, counted from 1.
    pub joints_not_covered: Vec<usize>,
}

/// The blocks once more, flagged rows included.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct AllRows {
    /// Nominal geometry.
    pub nominal: Option<Stats>,
    /// Identified model.
    pub identified: Option<Stats>,
    /// Held out.
    pub cross_validated: Option<Stats>,
}

/// Everything a verb has to say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// `truearm-report-1`
    pub schema: &'static str,
    /// The verb.
    pub command: &'static str,
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
    /// Norm of the corrections, in tolerances.
    pub correction_norm: f64,
    /// Residual scale over the stated sigma; well above 1 means structure that
    /// the model lacks.
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
    /// The validation file.
    pub validation: Option<Validation>,
    /// The blocks with flagged rows included.
    pub all_rows: AllRows,
    /// Flagged data rows, counted from 1.
    pub outlier_rows: Vec<usize>,
    /// What is wrong in them.
    pub outliers: Vec<FlaggedRow>,
    /// Combinations of parameters that move no measured point.
    pub unidentifiable: Vec<String>,
    /// Directions about which the data say less than the tolerances.
    pub weakly_determined: Vec<String>,
    /// 95 % error bars of parameters and of the predicted tool point.
    pub uncertainty: Uncertainty,
    /// Remarks.
    pub warnings: Vec<String>,
}

/// Rows to leave out of a held-out file on their own evidence: beyond 10 robust
/// standard deviations, the worst first, at most 1 % of the rows.
#[must_use]
pub fn own_evidence(residuals: &[impl Miss]) -> Vec<usize> {
    let d: Vec<f64> = residuals.iter().map(Miss::miss).collect();
    let scale = robust_distance_scale(&d);
    let mut rows: Vec<usize> = (0..d.len()).filter(|i| d[*i] > 10.0 * scale).collect();
    rows.sort_by(|a, b| d[*b].total_cmp(&d[*a]));
    rows.truncate(d.len() / 100);
    rows.sort_unstable();
    rows
}

/// Standard deviation of one coordinate from the median of 3-D distances.
#[must_use]
pub fn robust_distance_scale(distances: &[f64]) -> f64 {
    // Median of the chi distribution with three degrees of freedom.
    median(distances) / 1.538_172
}
