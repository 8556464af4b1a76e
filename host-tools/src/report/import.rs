use schemars::JsonSchema;
use serde::Serialize;

use crate::import::{Imported, ImportedColumn, ImportedFile};

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
    /// Data rows.
    pub rows: usize,
    /// Distinct poses among them; rows beyond are repetitions.
    pub poses: usize,
    /// How the files were read.
    pub files: Vec<ImportedFile>,
    /// How several files were put together, and why.
    pub join: Option<String>,
    /// What every column comes from, and why.
    pub columns: Vec<ImportedColumn>,
    /// Columns of the files that were not taken.
    pub left_out: Vec<String>,
    /// Remarks.
    pub warnings: Vec<String>,
}

impl ImportReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-import-1";

    /// Of what an import made, and the files it was written to.
    #[must_use]
    pub fn new(done: Imported, out: String, config: String) -> Self {
        Self {
            schema: Self::SCHEMA,
            command: "import",
            out,
            config,
            rows: done.rows,
            poses: done.poses,
            files: done.files,
            join: done.join,
            columns: done.columns,
            left_out: done.left_out,
            warnings: done.warnings,
        }
    }
}
