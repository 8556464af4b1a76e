//! Rows that are two ends of one measurement.

use super::source::Source;
use crate::error::Result;
use crate::model::{KindId, Measurements};

/// Joins rows of a kind that have a label in common: the second of the two holds
/// what was measured, whichever of them says it.
///
/// # Errors
/// A label of one row, or of more than two; a pair that says nothing.
pub(super) fn join(
    data: &mut Measurements,
    labels: &[Option<String>],
    source: Source,
) -> Result<()> {
    let mut ends: Vec<(KindId, &str, Vec<usize>)> = Vec::new();
    for (index, label) in labels.iter().enumerate() {
        let Some(label) = label else { continue };
        let kind = data.rows[index].kind;
        match ends.iter_mut().find(|(k, l, _)| (*k, *l) == (kind, label)) {
            Some((_, _, rows)) => rows.push(index),
            None => ends.push((kind, label, vec![index])),
        }
    }
    for (_, label, rows) in ends {
        let line = data.rows[*rows.last().unwrap_or(&0)].line;
        let fail = |message: String, help: &str| {
            Err(source.in_line(line, source.start_of(line), message, help))
        };
        let [first, second] = rows[..] else {
            let message = format!("{} rows with the pair \"{label}\"", rows.len());
            return fail(message, "give the two rows of a pair one label, and every pair its own");
        };
        let said = [second, first].into_iter().find(|row| !data.rows[*row].measured.is_empty());
        let Some(said) = said else {
            return fail(format!("pair \"{label}\" has no distance"), "fill in distance_mm");
        };
        data.rows[second].measured = data.rows[said].measured;
        data.rows[second].partner = Some(first);
    }
    Ok(())
}
