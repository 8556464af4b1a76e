//! What is settled before an import.

use super::config::FileConfig;
use crate::headings::Unit;

/// How several files become one table, as asked.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum JoinAsked {
    /// To be found.
    #[default]
    Find,
    /// Row by row.
    Order,
    /// One below the other.
    Stack,
    /// Where a column of this heading has the same label.
    Key(String),
}

/// What is settled beforehand.
#[derive(Debug, Clone, Default)]
pub struct ImportOptions {
    /// How the files are written.
    pub written: FileConfig,
    /// Unit of the joints that turn.
    pub angles: Option<Unit>,
    /// Unit of points, and of joints that slide.
    pub lengths: Option<Unit>,
    /// Pairs `q1=J1`.
    pub columns: Vec<String>,
    /// Form of the orientation.
    pub orientation: Option<String>,
    /// How the files belong together.
    pub join: JoinAsked,
    /// Leave rows out that lack a joint or a coordinate.
    pub skip_incomplete: bool,
}
