use schemars::JsonSchema;
use serde::Serialize;

use crate::verify::{COVERAGE_FACTOR, Conformity, Verification};

/// What `verify --json` prints, and its `report.json`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct VerifyReport {
    /// The schema.
    #[schemars(extend("const" = VerifyReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "verify"))]
    pub command: &'static str,
    /// The model that was packed and flashed.
    pub model: String,
    /// Measured with the compensation off.
    pub before: Option<Verification>,
    /// Measured with the compensation on.
    pub after: Verification,
    /// Of the expanded uncertainty.
    pub coverage_factor: f64,
    /// Largest error allowed, mm.
    pub tolerance_mm: Option<f64>,
    /// How conformity was decided.
    pub decision_rule: &'static str,
    /// What the tolerance says of the errors.
    pub conformity: Option<Conformity>,
    /// Remarks.
    pub warnings: Vec<String>,
}

impl VerifyReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-verify-1";

    /// Of a model file and its verified measurements, judged by a tolerance.
    #[must_use]
    pub fn new(
        model: String,
        before: Option<Verification>,
        after: Verification,
        tolerance_mm: Option<f64>,
        warnings: Vec<String>,
    ) -> Self {
        Self {
            schema: Self::SCHEMA,
            command: "verify",
            model,
            coverage_factor: COVERAGE_FACTOR,
            tolerance_mm,
            decision_rule: "ISO 14253-1, conformity to be proven, guard band U (k = 2)",
            conformity: tolerance_mm.map(|mm| after.conformity(mm)),
            before,
            after,
            warnings,
        }
    }
}
