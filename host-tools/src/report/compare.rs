use schemars::JsonSchema;
use serde::Serialize;

use crate::methods::Comparison;

/// What `compare --json` prints, and its `compare.json`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct CompareReport<'a> {
    /// The schema.
    #[schemars(extend("const" = CompareReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "compare"))]
    pub command: &'static str,
    /// The methods side by side.
    #[serde(flatten)]
    pub comparison: &'a Comparison,
}

impl<'a> CompareReport<'a> {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-compare-1";

    /// Of methods on one data set.
    #[must_use]
    pub fn new(comparison: &'a Comparison) -> Self {
        Self { schema: Self::SCHEMA, command: "compare", comparison }
    }
}
