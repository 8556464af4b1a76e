use schemars::JsonSchema;
use serde::Serialize;

use crate::evaluate::Validation;

/// What `evaluate --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EvaluateReport {
    /// The schema.
    #[schemars(extend("const" = EvaluateReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "evaluate"))]
    pub command: &'static str,
    /// The model.
    pub model: String,
    /// The scored file.
    pub validation: Validation,
    /// Remarks.
    pub warnings: Vec<String>,
}

impl EvaluateReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-evaluate-1";

    /// Of a model file and what it scored.
    #[must_use]
    pub fn new(model: String, validation: Validation, warnings: Vec<String>) -> Self {
        Self { schema: Self::SCHEMA, command: "evaluate", model, validation, warnings }
    }
}
