//! What an import made.

use schemars::JsonSchema;
use serde::Serialize;

use super::config::FileConfig;

/// What an import made.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Imported {
    /// Text of measurements.csv.
    #[serde(skip)]
    pub csv: String,
    /// Text of import.toml.
    #[serde(skip)]
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

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ImportedFile {
    /// How it is written.
    #[serde(flatten)]
    pub written: FileConfig,
    /// Its rows of data.
    pub rows: usize,
    /// What says so.
    pub because: Vec<String>,
}

/// A column and what it means.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ImportedColumn {
    /// As truearm calls it: q1.., x, y, z, station, qw, roll, r11 ...
    pub to: String,
    /// Number of the file, from 1.
    pub file: usize,
    /// Number of the column, from 1.
    pub column: usize,
    /// Its heading; empty without.
    pub name: String,
    /// Its unit in the file; none of labels and plain numbers.
    pub unit: Option<String>,
    /// What says so.
    pub because: String,
}
