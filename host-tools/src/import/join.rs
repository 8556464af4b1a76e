//! Several files as one table: where their rows belong together.

use std::collections::{HashMap, HashSet};

use super::config::Join;
use super::options::JoinAsked;
use super::table::Table;
use crate::error::{Error, Place, Result};
use crate::headings::{Named, Role};

/// One row of the joined table: of which file it is if they were stacked, and
/// its row in each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct RowRef {
    pub stacked: Option<usize>,
    pub rows: Vec<usize>,
}

impl RowRef {
    /// File and row that a column of `file` is read from.
    pub fn at(&self, file: usize) -> (usize, usize) {
        match self.stacked {
            Some(stacked) => (stacked, self.rows[0]),
            None => (file, self.rows[file]),
        }
    }
}

/// How the files belong together: as asked, one below the other where each has
/// everything, by a key that they share, or row by row.
///
/// # Errors
/// Files of different lengths without a key.
pub(super) fn decide(
    tables: &[Table],
    asked: &JoinAsked,
    complete: bool,
) -> Result<(Join, String)> {
    let asked_for = || "it was asked for".to_owned();
    match asked {
        _ if tables.len() == 1 => return Ok((Join::Order, "there is one file".to_owned())),
        JoinAsked::Order => return Ok((Join::Order, asked_for())),
        JoinAsked::Stack => return Ok((Join::Stack, asked_for())),
        JoinAsked::Key(name) => {
            let find = |table: &Table| {
                table.headings.iter().position(|h| h.text.eq_ignore_ascii_case(name)).ok_or_else(
                    || {
                        let help = format!("it has {}", table.list());
                        Error::file(
                            &table.path,
                            Place::default(),
                            format!("no column {name}"),
                            help,
                        )
                    },
                )
            };
            return Ok((Join::Key(tables.iter().map(find).collect::<Result<_>>()?), asked_for()));
        }
        JoinAsked::Find => {}
    }
    if complete {
        return Ok((Join::Stack, "each file has joints and points".to_owned()));
    }
    if let Some((keys, because)) = key(tables) {
        return Ok((Join::Key(keys), because));
    }
    let counts: Vec<usize> = tables.iter().map(|t| t.rows.len()).collect();
    if counts.iter().all(|c| *c == counts[0]) {
        return Ok((
            Join::Order,
            format!("each file has {} rows and they share no key", counts[0]),
        ));
    }
    let of = tables.iter().map(|t| format!("{} has {}", t.path.display(), t.rows.len()));
    Err(Error::usage(
        format!("files of different lengths: {} rows", of.collect::<Vec<_>>().join(", ")),
        "name the column that says which rows belong together: --join COLUMN; or make the files equally \
         long and use --join order",
    ))
}

/// A key as it is compared: the number at the end of a label, or the label.
fn labels(table: &Table, column: usize, numbered: bool) -> Vec<String> {
    let label = |row| {
        let text = table.text(row, column);
        let digits = text.len() - text.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let number = text[text.len() - digits..].trim_start_matches('0');
        if numbered && digits > 0 { format!("#{number}") } else { text.to_owned() }
    };
    (0..table.rows.len()).map(label).collect()
}

/// A column each that holds the same labels.
fn key(tables: &[Table]) -> Option<(Vec<usize>, String)> {
    let first = &tables[0];
    for (column, heading) in first.headings.iter().enumerate() {
        let same = |t: &Table| {
            let like = |h: &&crate::headings::Heading| {
                !h.text.is_empty() && h.text.eq_ignore_ascii_case(&heading.text)
                    || keyed(h) && keyed(heading)
            };
            t.headings.iter().position(|h| like(&h))
        };
        let Some(rest) = tables[1..].iter().map(same).collect::<Option<Vec<_>>>() else { continue };
        let columns: Vec<usize> = std::iter::once(column).chain(rest).collect();
        if matches(tables, &columns) {
            let names: Vec<String> =
                columns.iter().zip(tables).map(|(c, t)| t.called(*c)).collect();
            return Some((columns, format!("{} hold the same labels", names.join(" and "))));
        }
    }
    None
}

/// Whether a heading sounds like a key.
fn keyed(heading: &crate::headings::Heading) -> bool {
    let words = ["id", "point", "name", "pose", "punkt", "label", "key", "poseid", "pointid"];
    heading.words.last().is_some_and(|w| words.contains(&w.as_str()))
        || Named::of(heading).is_some_and(|n| n.role == Role::Order)
}

/// Whether at least half the rows of every file find a partner in all others,
/// and at most one file repeats a label.
fn matches(tables: &[Table], columns: &[usize]) -> bool {
    [false, true].into_iter().any(|numbered| {
        let all: Vec<Vec<String>> =
            tables.iter().zip(columns).map(|(t, c)| labels(t, *c, numbered)).collect();
        let sets: Vec<HashSet<&String>> =
            all.iter().map(|labels| labels.iter().collect()).collect();
        let repeats = all.iter().zip(&sets).filter(|(l, s)| l.len() > s.len()).count();
        let found = |labels: &Vec<String>| {
            labels.iter().filter(|l| sets.iter().all(|set| set.contains(l))).count()
        };
        repeats <= 1 && all.iter().all(|labels| 2 * found(labels) >= labels.len())
    })
}

/// The rows of the joined table; `base` is the file whose rows are followed.
///
/// # Errors
/// Files that do not fit together as said.
pub(super) fn rows(
    tables: &[Table],
    join: &Join,
    base: usize,
    warnings: &mut Vec<String>,
) -> Result<Vec<RowRef>> {
    match join {
        Join::Stack => {
            if let Some(other) = tables.iter().find(|t| names(t) != names(&tables[0])) {
                let message = format!("other headings than {}", tables[0].path.display());
                let help =
                    "files are stacked if they have the same columns; import them one by one";
                return Err(Error::file(&other.path, Place::default(), message, help));
            }
            let all = tables.iter().enumerate();
            let rows = all.flat_map(|(file, t)| {
                (0..t.rows.len()).map(move |row| RowRef { stacked: Some(file), rows: vec![row] })
            });
            Ok(rows.collect())
        }
        Join::Order => {
            let count = tables[base].rows.len();
            if let Some(other) = tables.iter().find(|t| t.rows.len() != count) {
                let message = format!(
                    "{} rows where {} has {count}",
                    other.rows.len(),
                    tables[base].path.display()
                );
                let help = "rows joined by their order must be as many: --join COLUMN names a key";
                return Err(Error::file(&other.path, Place::default(), message, help));
            }
            let all = |row| RowRef { stacked: None, rows: vec![row; tables.len()] };
            Ok((0..count).map(all).collect())
        }
        Join::Key(columns) => keyed_rows(tables, columns, base, warnings),
    }
}

fn names(table: &Table) -> Vec<&str> {
    table.headings.iter().map(|h| h.text.as_str()).collect()
}

fn keyed_rows(
    tables: &[Table],
    columns: &[usize],
    base: usize,
    warnings: &mut Vec<String>,
) -> Result<Vec<RowRef>> {
    let plain: Vec<_> = tables.iter().zip(columns).map(|(t, c)| labels(t, *c, false)).collect();
    let known = |all: &[Vec<String>]| {
        let sets: Vec<HashSet<&String>> = all.iter().map(|o| o.iter().collect()).collect();
        all[base].iter().filter(|l| sets.iter().all(|set| set.contains(l))).count()
    };
    let numbered: Vec<_> = tables.iter().zip(columns).map(|(t, c)| labels(t, *c, true)).collect();
    let all = if known(&plain) >= known(&numbered) { plain } else { numbered };
    let mut places: Vec<HashMap<&str, usize>> = Vec::new();
    for (file, labels) in all.iter().enumerate() {
        let mut at = HashMap::new();
        for (row, label) in labels.iter().enumerate() {
            if at.insert(label.as_str(), row).is_some() && file != base {
                let message = format!(
                    "label \"{}\" stands there twice",
                    tables[file].text(row, columns[file])
                );
                let help =
                    "a key must be unique in all files but that of the points; mend the labels";
                return Err(tables[file].fail(row, columns[file], message, help));
            }
        }
        places.push(at);
    }
    let mut lonely = Vec::new();
    let mut rows = Vec::new();
    for (row, label) in all[base].iter().enumerate() {
        let at = |file: usize| {
            if file == base { Some(row) } else { places[file].get(label.as_str()).copied() }
        };
        match (0..tables.len()).map(at).collect::<Option<Vec<_>>>() {
            Some(found) => rows.push(RowRef { stacked: None, rows: found }),
            None => lonely.push(tables[base].text(row, columns[base]).to_owned()),
        }
    }
    for (file, labels) in all.iter().enumerate().filter(|(file, _)| *file != base) {
        let missing =
            labels.iter().enumerate().filter(|(_, l)| !places[base].contains_key(l.as_str()));
        lonely.extend(missing.map(|(row, _)| tables[file].text(row, columns[file]).to_owned()));
    }
    if !lonely.is_empty() {
        warnings.push(format!(
            "rows without a partner in the other files left out: {}",
            lonely.join(", ")
        ));
    }
    if rows.is_empty() {
        return Err(Error::usage(
            "no label of one file is in the other",
            "name another column with --join COLUMN, or use --join order",
        ));
    }
    Ok(rows)
}
