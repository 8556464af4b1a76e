use schemars::JsonSchema;
use serde::Serialize;

use crate::gram::{Part, Step};

/// What `gram step --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GramReport {
    /// The schema.
    #[schemars(extend("const" = GramReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "gram step"))]
    pub command: &'static str,
    /// Files that the sums are of.
    pub files: u64,
    /// Rows in them.
    pub rows: u64,
    /// Rows that did not count: beyond what the state says in `weights`.
    pub flagged: u64,
    /// Rounds taken, this one among them.
    pub stage: u32,
    /// Whether another round would change nothing.
    pub settled: bool,
    /// Scale of the residuals in stated sigmas, at least 1.
    pub noise_scale: f64,
    /// The regularisation parameter of this round.
    pub lambda: f64,
    /// Largest step of an unknown, in tolerances.
    pub largest_step_tolerances: f64,
    /// Root mean square of the distances that the state of the sums leaves, each weighed by
    /// 1/sigma^2; none in the first round.
    pub rms_mm: Option<f64>,
    /// The same of poses that were held out, a tenth at a time.
    pub cross_validated_rms_mm: Option<f64>,
}

impl GramReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-gram-1";

    /// Of a step by some sums.
    #[must_use]
    pub fn new(step: &Step, sums: &Part) -> Self {
        let gram = step.model.gram.clone().unwrap_or_default();
        Self {
            schema: Self::SCHEMA,
            command: "gram step",
            files: sums.files(),
            rows: sums.rows(),
            flagged: sums.flagged(),
            stage: gram.stage,
            settled: gram.settled,
            noise_scale: gram.k,
            lambda: step.model.provenance.lambda,
            largest_step_tolerances: step.largest,
            rms_mm: step.rms_mm,
            cross_validated_rms_mm: step.cross_validated_rms_mm,
        }
    }
}
