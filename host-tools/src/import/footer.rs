//! Rows that sum up the others: averages and the like, which are no measurements.

use std::collections::HashSet;
use std::path::Path;

use super::sniff::Line;

/// Their labels, in lower case and without anything between the letters. No `range`: that is
/// a kind of measurement, and a file may end with one.
const WORDS: [&str; 24] = [
    "average",
    "avg",
    "mean",
    "median",
    "mittelwert",
    "mittel",
    "std",
    "stdev",
    "stddev",
    "sd",
    "standarddeviation",
    "standardabweichung",
    "sigma",
    "variance",
    "min",
    "max",
    "minimum",
    "maximum",
    "rms",
    "spannweite",
    "sum",
    "summe",
    "count",
    "anzahl",
];

fn is_word(cell: &str) -> bool {
    let letters = |c: &char| !c.is_whitespace() && !".:-_".contains(*c);
    let word: String = cell.chars().filter(letters).flat_map(char::to_lowercase).collect();
    WORDS.contains(&word.as_str())
}

/// Takes them out of the rows and says so; `None` without any.
pub(super) fn take(path: &Path, rows: &mut Vec<&Line>) -> Option<String> {
    let width = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let column = (0..width).find(|column| sums_up(rows, *column))?;
    let said: Vec<String> = rows
        .iter()
        .filter(|row| row.cells.get(column).is_some_and(|cell| is_word(cell)))
        .map(|row| format!("\"{}\" (line {})", row.cells[column], row.number))
        .collect();
    rows.retain(|row| row.cells.get(column).is_none_or(|cell| !is_word(cell)));
    Some(format!("{}: rows that sum up the others left out: {}", path.display(), said.join(", ")))
}

/// Whether a column has such words and they are no labels of rows like others: these
/// are labels of their own, or the words stand behind all of them.
fn sums_up(rows: &[&Line], column: usize) -> bool {
    let cells: Vec<&str> =
        rows.iter().map(|row| row.cells.get(column).map_or("", String::as_str)).collect();
    let words: Vec<&str> = cells.iter().copied().filter(|cell| is_word(cell)).collect();
    let others: Vec<&str> = cells.iter().copied().filter(|cell| !is_word(cell)).collect();
    let once = |of: &[&str]| of.iter().collect::<HashSet<_>>().len() == of.len();
    let labelled = others.iter().all(|cell| !cell.is_empty()) && once(&others);
    let behind = cells.iter().skip(others.len()).all(|cell| is_word(cell)) && once(&words);
    !words.is_empty() && others.len() >= 2 && (labelled || behind)
}
