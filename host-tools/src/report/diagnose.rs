use schemars::JsonSchema;
use serde::Serialize;

use crate::diagnose::Outcome;

/// What `diagnose --json` prints, and its `report.json`: the figures of
/// `identify` for the final model, and what was found.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DiagnoseReport {
    /// The schema.
    #[schemars(extend("const" = DiagnoseReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "diagnose"))]
    pub command: &'static str,
    /// What was found.
    #[serde(flatten)]
    pub outcome: Outcome,
}

impl DiagnoseReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-diagnose-1";

    /// Of a diagnosis.
    #[must_use]
    pub fn new(outcome: Outcome) -> Self {
        Self { schema: Self::SCHEMA, command: "diagnose", outcome }
    }
}
