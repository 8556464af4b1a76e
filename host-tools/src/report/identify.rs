use schemars::JsonSchema;
use serde::Serialize;

use crate::evaluate::Validation;
use crate::identify::Figures;

/// What `identify --json` prints, and its `report.json`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct IdentifyReport {
    /// The schema.
    #[schemars(extend("const" = IdentifyReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "identify"))]
    pub command: &'static str,
    /// Figures of the identified arm.
    #[serde(flatten)]
    pub figures: Figures,
    /// The validation file.
    pub validation: Option<Validation>,
}

impl IdentifyReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-identify-1";

    /// Of an identification, and of a file scored with it.
    #[must_use]
    pub fn new(figures: Figures, validation: Option<Validation>) -> Self {
        Self { schema: Self::SCHEMA, command: "identify", figures, validation }
    }
}
