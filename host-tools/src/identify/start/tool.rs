//! Which of the markers stands for the tool: one whose place some row says, whatever the
//! order of the rows. An inclinometer is a marker without a place, a ray begins at one
//! that no target sits on.

use crate::model::{Measurements, Model};
use crate::observations::{equations_of, kind};

/// Markers whose place in the last frame no row says, by label.
#[must_use]
pub fn not_measured(data: &Measurements) -> Vec<String> {
    let said = |marker: usize| {
        let mut rows = data.rows.iter().filter(|row| row.marker == marker);
        rows.any(|row| equations_of(row) > 0 && kind(row).of_target(row))
    };
    let without = data.markers.iter().enumerate().filter(|(marker, _)| !said(*marker));
    without.map(|(_, label)| label.clone()).collect()
}

/// The marker that stands for the tool, as [`Model::tool_marker`] has it; `None` where no
/// row says where any is.
#[must_use]
pub fn of(data: &Measurements) -> Option<usize> {
    let without = not_measured(data);
    let measured = data.markers.iter().filter(|label| !without.contains(label));
    let label = Model::first_of(measured)?;
    data.markers.iter().position(|l| l == label)
}
