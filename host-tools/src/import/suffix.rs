//! Units behind the numbers of a table, in every cell: `12.3°`, `5 mm`.

use std::path::Path;

use super::number::number;
use super::sniff::Line;
use crate::error::{Error, Place, Result};
use crate::headings::{Heading, Quantity, Unit};

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

/// A number and the unit behind it; `None` of everything else.
pub(super) fn cut(cell: &str, decimal: char) -> Option<(String, Unit)> {
    let last = cell.rfind(|c: char| c.is_ascii_digit())?;
    let (bare, rest) = cell.split_at(last + 1);
    let unit = Unit::of_word(rest.trim()).filter(|_| !rest.trim().is_empty())?;
    let measures = [Quantity::Angle, Quantity::Length].contains(&unit.quantity());
    (measures && number(bare, decimal).is_some()).then(|| (bare.to_owned(), unit))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_units() {
        for (cell, decimal, expected) in [
            ("12.3°", '.', Some(("12.3", Unit::Deg))),
            ("5 mm", '.', Some(("5", Unit::Mm))),
            ("-0,25 rad", ',', Some(("-0,25", Unit::Rad))),
            ("12", '.', None),
            ("J1", '.', None),
            ("12°30'", '.', None),
            ("3 kg", '.', None),
            ("P7 mm", '.', None),
        ] {
            let expected = expected.map(|(bare, unit)| (bare.to_owned(), unit));
            assert_eq!(cut(cell, decimal), expected, "{cell}");
        }
    }
}
