use schemars::JsonSchema;
use serde::Serialize;

use crate::import::Imported;

/// What `import --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ImportReport {
    /// The schema.
    #[schemars(extend("const" = ImportReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "import"))]
    pub command: &'static str,
    /// The measurements.csv that was written.
    pub out: String,
    /// The import.toml that was written beside it or read.
    pub config: String,
    /// What the import made.
    #[serde(flatten)]
    pub made: Imported,
}

impl ImportReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-import-1";

    /// Of what an import made, and the files it was written to.
    #[must_use]
    pub fn new(made: Imported, out: String, config: String) -> Self {
        Self { schema: Self::SCHEMA, command: "import", out, config, made }
    }
}
