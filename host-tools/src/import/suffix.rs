//! Units behind the numbers of a table, in every cell: `12.3°`, `5 mm`.

use std::path::Path;

use super::number::cut;
use super::sniff::Line;
use crate::error::{Error, Place, Result};
use crate::headings::{Heading, Unit};

/// Takes the units out of cells; of each column that has some, which.
///
/// # Errors
/// A column with two.
pub(super) fn taken_out(
    path: &Path,
    lines: &mut [Line],
    decimal: char,
) -> Result<Vec<Option<Unit>>> {
    let mut units: Vec<Option<Unit>> = Vec::new();
    for line in lines {
        for (column, cell) in line.cells.iter_mut().enumerate() {
            let Some((bare, unit)) = cut(cell, decimal) else { continue };
            units.resize(units.len().max(column + 1), None);
            let known = *units[column].get_or_insert(unit);
            if known != unit {
                let (first, second) = (known.word(), unit.word());
                let message = format!("column {} has {first} and {second}", column + 1);
                let help = "convert the cells of a column to one unit";
                return Err(Error::file(path, Place::line(line.number), message, help));
            }
            *cell = bare;
        }
    }
    Ok(units)
}

/// The units of cells as those of the columns.
///
/// # Errors
/// A heading that says another.
pub(super) fn told(path: &Path, headings: &mut [Heading], units: &[Option<Unit>]) -> Result<()> {
    for (heading, unit) in headings.iter_mut().zip(units) {
        let Some(unit) = unit else { continue };
        if let Some(said) = heading.unit.filter(|said| said != unit) {
            let (text, said, unit) = (&heading.text, said.word(), unit.word());
            let message = format!("\"{text}\" says {said}, but its cells say {unit}");
            let help = "mend the heading, or the cells";
            return Err(Error::file(path, Place::default(), message, help));
        }
        heading.unit = Some(*unit);
        heading.strange = None;
    }
    Ok(())
}
