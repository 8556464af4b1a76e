use schemars::JsonSchema;
use serde::Serialize;

use super::compensate::RowLeft;
use crate::model::Path;
use crate::paths::Followed;

/// What `ik --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct IkReport {
    /// The schema.
    #[schemars(extend("const" = IkReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "ik"))]
    pub command: &'static str,
    /// The model, or the robot.
    pub model: String,
    /// The poses.
    pub path: String,
    /// Their rows.
    pub rows: usize,
    /// Whether the joints are the nominal arm's.
    pub nominal: bool,
    /// Rows that the arm does not reach, with what is left at the nearest.
    pub not_reached: Vec<RowLeft>,
    /// The file of the joints.
    pub out: String,
    /// Remarks.
    pub warnings: Vec<String>,
}

impl IkReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-ik-1";

    /// Of a path of poses and the joints that were found.
    #[must_use]
    pub fn new(
        [model, out]: [String; 2],
        path: &Path,
        nominal: bool,
        found: &Followed,
        warnings: Vec<String>,
    ) -> Self {
        let rows = found.rows.iter().zip(&path.data.rows).filter(|(found, _)| !found.is_reached());
        Self {
            schema: Self::SCHEMA,
            command: "ik",
            model,
            path: path.data.path.display().to_string(),
            rows: path.data.rows.len(),
            nominal,
            not_reached: rows
                .map(|(found, row)| RowLeft::new(row.line, [found.position, found.rotation]))
                .collect(),
            out,
            warnings,
        }
    }
}
