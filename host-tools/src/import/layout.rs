//! Where a table begins: lines before it, headings, a row of units, data.

use std::path::Path;

use super::footer;
use super::number::number;
use super::sniff::{Line, commonest};
use crate::error::{Error, Place, Result};
use crate::headings::{Heading, Unit};

/// The lines of a table, by their numbers in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub header: Option<usize>,
    pub units: Option<usize>,
    /// First line of data.
    pub data: usize,
}

/// What a line begins with that is a comment.
const COMMENT: [&str; 4] = ["#", "//", "%", "!"];

/// A comment by its first cell.
fn comment(line: &Line) -> bool {
    line.cells.first().is_some_and(|cell| COMMENT.iter().any(|sign| cell.starts_with(sign)))
}

/// Without a comment's sign in front, and without empty cells at the end.
fn cells_of(line: &Line, width: usize) -> Vec<String> {
    let mut cells = line.cells.clone();
    while cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
    if comment(line) {
        let bare = cells[0].trim_start_matches(['#', '/', '%', '!']).trim().to_owned();
        // Above the numbers of rows `#` is a heading; a sign is a cell too many.
        match bare.is_empty() {
            true if cells.len() > width => drop(cells.remove(0)),
            true => {}
            false => cells[0] = bare,
        }
    }
    cells
}

fn numbers(cells: &[String], decimal: char) -> usize {
    cells.iter().filter(|c| number(c, decimal).is_some()).count()
}

/// A row of units: words of units and nothing else, at least one of them.
fn unit_row(cells: &[String]) -> bool {
    let filled: Vec<_> = cells.iter().filter(|c| !c.is_empty()).collect();
    let known = |c: &&String| Unit::of_word(c).is_some_and(|u| u != Unit::Plain);
    filled.iter().any(known) && filled.iter().all(|c| Unit::of_word(c).is_some())
}

/// Headings: mostly words. Joints may be called by their bare numbers.
fn header_row(cells: &[String], width: usize, decimal: char) -> bool {
    let filled = cells.iter().filter(|c| !c.is_empty()).count();
    let words = filled - numbers(cells, decimal);
    2 * filled >= width && words >= 2 && 3 * words >= filled && cells.len() <= width + 1
}

/// Finds the lines; `header` is what was asked for: a line, or 0 for none.
///
/// # Errors
/// No rows of numbers, and a line asked for that is not there.
pub(super) fn find(
    path: &Path,
    lines: &[Line],
    decimal: char,
    header: Option<usize>,
) -> Result<Layout> {
    let rows = lines.iter().filter(|l| !comment(l) && numbers(&l.cells, decimal) >= 2);
    let width = commonest(rows.clone().map(|l| l.cells.len()));
    let usual =
        commonest(rows.filter(|l| l.cells.len() == width).map(|l| numbers(&l.cells, decimal)));
    let data = |l: &Line| {
        !comment(l) && l.cells.len() == width && 2 * numbers(&l.cells, decimal) > usual.max(2)
    };
    let after = header.filter(|line| *line > 0);
    let start = lines.iter().position(|l| data(l) && after.is_none_or(|line| l.number > line));
    let Some(start) = start else {
        let help = "a table has at least two numbers a row; --delimiter and --decimal say how it is written";
        return Err(Error::file(path, Place::default(), "no rows of numbers found", help));
    };
    let mut layout = Layout { header: None, units: None, data: lines[start].number };
    let above = &lines[..start];
    if let Some(asked) = header {
        if asked > 0 && !lines.iter().any(|l| l.number == asked) {
            let help = "give the line of the headings, counted from 1, or 0 if there are none";
            return Err(Error::usage(format!("--header {asked}: no such line"), help));
        }
        layout.header = after;
        let between = above.iter().filter(|l| after.is_some_and(|line| l.number > line));
        layout.units = between
            .map(|l| (l, cells_of(l, width)))
            .find(|(_, c)| unit_row(c))
            .map(|(l, _)| l.number);
        return Ok(layout);
    }
    // Nothing but units may stand between the headings and the data.
    for line in above.iter().rev() {
        let cells = cells_of(line, width);
        if layout.units.is_none() && unit_row(&cells) {
            layout.units = Some(line.number);
        } else if header_row(&cells, width, decimal) {
            layout.header = Some(line.number);
            break;
        } else if !comment(line) {
            break;
        }
    }
    Ok(layout)
}

/// A table whose lines are known.
pub(super) struct Body {
    pub headings: Vec<Heading>,
    pub rows: Vec<Line>,
    pub warnings: Vec<String>,
    /// Units that remarks above the table say of all its columns, and in which line.
    pub remarked: Vec<(Unit, usize)>,
}

/// What stands in a remark before a unit: `Part: tool   Units: Inches`.
const UNITS_ARE: [&str; 4] = ["units", "unit", "einheit", "einheiten"];

/// Units that the lines above a table say.
fn remarked(lines: &[Line], layout: Layout) -> Vec<(Unit, usize)> {
    let first = layout.header.or(layout.units).unwrap_or(layout.data);
    let mut found = Vec::new();
    for line in lines.iter().filter(|line| line.number < first) {
        let text = line.cells.join(" ");
        let words: Vec<&str> =
            text.split([' ', ':', '=', ',', '\t']).filter(|word| !word.is_empty()).collect();
        let said = words.windows(2).filter(|w| UNITS_ARE.contains(&w[0].to_lowercase().as_str()));
        found.extend(said.filter_map(|w| Unit::of_word(w[1])).map(|unit| (unit, line.number)));
    }
    found
}

/// Takes the lines apart.
///
/// # Errors
/// A row with another number of cells than the others.
pub(super) fn body(path: &Path, lines: Vec<Line>, layout: Layout, decimal: char) -> Result<Body> {
    let mut rows: Vec<&Line> =
        lines.iter().filter(|l| l.number >= layout.data && !comment(l)).collect();
    // A footer has words where the rows have numbers.
    let last = rows.iter().rposition(|l| numbers(&l.cells, decimal) >= 2).map_or(0, |i| i + 1);
    let width = commonest(rows[..last].iter().map(|l| l.cells.len()));
    let mut warnings = Vec::new();
    if let Some(footer) = rows.get(last) {
        let count = rows.len() - last;
        warnings.push(format!(
            "{}: {count} lines behind the table left out, from line {} on",
            path.display(),
            footer.number
        ));
    }
    rows.truncate(last);
    warnings.extend(footer::take(path, &mut rows));
    if let Some(odd) = rows.iter().find(|l| l.cells.len() != width) {
        let message = format!("{} cells where other rows have {width}", odd.cells.len());
        let help = "give every row a cell for every column, empty ones for what is unknown; delete \
                    rows that do not belong to the table";
        return Err(Error::file(path, Place::line(odd.number), message, help));
    }
    let at = |line: Option<usize>| {
        lines.iter().find(|l| Some(l.number) == line).map(|l| cells_of(l, width))
    };
    let (header, units) = (at(layout.header), at(layout.units));
    let name = |i: usize| header.as_ref().and_then(|h| h.get(i)).map_or("", String::as_str);
    let mut headings: Vec<Heading> = (0..width).map(|i| Heading::new(name(i))).collect();
    for (heading, unit) in headings.iter_mut().zip(units.unwrap_or_default()) {
        heading.unit = Unit::of_word(&unit).filter(|u| *u != Unit::Plain).or(heading.unit);
        if heading.unit.is_some() {
            heading.strange = None;
        }
    }
    let rows = rows.into_iter().cloned().collect();
    Ok(Body { headings, rows, warnings, remarked: remarked(&lines, layout) })
}
