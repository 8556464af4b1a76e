use schemars::JsonSchema;
use serde::Serialize;

use crate::check::{Finding, LEAST_POSES, Said, Stray, Verdict};
use crate::units::to_mm;

/// What `check --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CheckReport {
    /// The schema.
    #[schemars(extend("const" = CheckReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "check"))]
    pub command: &'static str,
    /// The robot file.
    pub robot: String,
    /// The measurements.
    pub data: String,
    /// `sound`, `mendable` (found wrong, and what undoes it) or
    /// `not-understood`.
    pub verdict: Verdict,
    /// What is wrong.
    pub changes: Vec<Said>,
    /// Other mistakes that explain the same: the data cannot tell them from
    /// the changes.
    pub equivalent: Vec<Vec<Said>>,
    /// Misfit of the next explanation that is not as good over that of the
    /// changes.
    pub margin: Option<f64>,
    /// Mistakes that these data cannot show: base or tool absorb them.
    pub absorbed: Vec<String>,
    /// Rows that are far off, if there are any.
    pub stray: Option<Stray>,
    /// Root mean square misfit as the files are, links within their tolerances,
    /// rows far off left out where they are few, mm.
    pub rms_before_mm: f64,
    /// The same with the mistakes undone, mm.
    pub rms_after_mm: f64,
    /// Largest correction of a link that the fit of the files as they are needs, in tolerances.
    pub largest_correction_tolerances: f64,
    /// Poses of different joint values that the measurements have.
    pub poses: usize,
    /// So many are needed to decide anything.
    pub poses_needed: usize,
    /// Why nothing can be decided, where poses or points are too few.
    pub too_few: Option<String>,
    /// Remarks.
    pub warnings: Vec<String>,
}

impl CheckReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-check-1";

    /// Of a robot file and its measurements.
    #[must_use]
    pub fn new(robot: String, data: String, finding: &Finding, warnings: Vec<String>) -> Self {
        Self {
            schema: Self::SCHEMA,
            command: "check",
            robot,
            data,
            verdict: finding.verdict,
            changes: finding.said.clone(),
            equivalent: finding.equivalent.clone(),
            margin: finding.margin,
            absorbed: finding.absorbed.clone(),
            stray: finding.stray.clone(),
            rms_before_mm: to_mm(finding.rms_before),
            largest_correction_tolerances: finding.correction_before,
            rms_after_mm: to_mm(finding.rms_after),
            poses: finding.poses,
            poses_needed: LEAST_POSES,
            too_few: finding.too_few.clone(),
            warnings,
        }
    }
}
