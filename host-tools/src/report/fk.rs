use schemars::JsonSchema;
use serde::Serialize;

use crate::paths::View;

/// What `fk --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FkReport {
    /// The schema.
    #[schemars(extend("const" = FkReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "fk"))]
    pub command: &'static str,
    /// The model, or the robot.
    pub model: String,
    /// The joints.
    pub path: String,
    /// Their rows.
    pub rows: usize,
    /// Whether the tool is the nominal arm's.
    pub nominal: bool,
    /// The station whose frame the poses are in; `null`: the coordinates of the
    /// robot file, in which `[base]` is stated.
    pub station: Option<String>,
    /// The target in place of `[tool]`, if one was named.
    pub marker: Option<String>,
    /// The file of the poses.
    pub out: String,
    /// Remarks.
    pub warnings: Vec<String>,
}

impl FkReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-fk-1";

    /// Of so many rows of a file, seen in this way and written to another.
    #[must_use]
    pub fn new(
        [model, path, out]: [String; 3],
        rows: usize,
        nominal: bool,
        view: View,
        warnings: Vec<String>,
    ) -> Self {
        let View { station, marker } = view;
        let (schema, command) = (Self::SCHEMA, "fk");
        Self { schema, command, model, path, rows, nominal, station, marker, out, warnings }
    }
}
