//! Several files as one table: where their rows belong together.

use std::collections::HashMap;

use super::config::Join;
use super::key;
use super::labels::Compared;
use super::options::JoinAsked;
use super::table::Table;
use crate::error::{Error, Place, Result};

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
    warnings: &mut Vec<String>,
) -> Result<(Join, String)> {
    let asked_for = || "it was asked for".to_owned();
    match asked {
        _ if tables.len() == 1 => return Ok((Join::Order, "there is one file".to_owned())),
        JoinAsked::Order => return Ok((Join::Order, asked_for())),
        JoinAsked::Stack => return Ok((Join::Stack, asked_for())),
        JoinAsked::Key(name) => return Ok((Join::Key(key::named(tables, name)?), asked_for())),
        JoinAsked::Find => {}
    }
    if complete {
        return Ok((Join::Stack, "each file has joints and points".to_owned()));
    }
    let key = key::find(tables);
    if key.as_ref().is_none_or(|key| key.count) {
        warnings.extend(key::ignored_labels(tables));
    }
    if let Some(key) = key {
        return Ok((Join::Key(key.columns), key.because));
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
    let all = Compared::of(&tables.iter().collect::<Vec<_>>(), columns).keys;
    let mut places: Vec<HashMap<&str, usize>> = Vec::new();
    for (file, labels) in all.iter().enumerate() {
        let mut at = HashMap::new();
        for (row, label) in labels.iter().enumerate() {
            let Some(label) = label else { continue };
            if at.insert(label.as_str(), row).is_some() && file != base {
                let message = format!(
                    "label \"{}\" stands there twice",
                    tables[file].text(row, columns[file])
                );
                let help = "a key must be unique in all files but that of what was measured; mend the labels";
                return Err(tables[file].fail(row, columns[file], message, help));
            }
        }
        places.push(at);
    }
    let called = |file: usize, row: usize| match tables[file].text(row, columns[file]) {
        "" => format!("line {} without a label", tables[file].rows[row].number),
        label => label.to_owned(),
    };
    let mut lonely = Vec::new();
    let mut rows = Vec::new();
    for (row, label) in all[base].iter().enumerate() {
        let at = |file: usize| {
            let label = label.as_ref()?;
            if file == base { Some(row) } else { places[file].get(label.as_str()).copied() }
        };
        match (0..tables.len()).map(at).collect::<Option<Vec<_>>>() {
            Some(found) => rows.push(RowRef { stacked: None, rows: found }),
            None => lonely.push(called(base, row)),
        }
    }
    for (file, labels) in all.iter().enumerate().filter(|(file, _)| *file != base) {
        let known =
            |l: &Option<String>| l.as_ref().is_some_and(|l| places[base].contains_key(l.as_str()));
        let missing = labels.iter().enumerate().filter(|(_, l)| !known(l));
        lonely.extend(missing.map(|(row, _)| called(file, row)));
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
            "name another column with --join COLUMN, or --join ONE=OTHER where headings differ, or use --join order",
        ));
    }
    Ok(rows)
}
