//! `--columns`: what the user says a column is.

use std::collections::BTreeMap;

use super::clues::{Clues, Place};
use crate::error::{Error, Result};
use crate::import::config::{ORDER, is_name};

const HELP: &str = "give pairs such as q1=J1,x=\"Pos X\",station=2:Stand: the name here, the heading or the \
                    number of the column there, the file's number before it where there are several; \
                    q=1-6 and xyz=7-9 name ranges";

/// By the name in truearm.
pub(super) fn read(clues: &Clues) -> Result<BTreeMap<String, Place>> {
    let mut given = BTreeMap::new();
    for text in &clues.options.columns {
        let (to, from) =
            text.split_once('=').ok_or_else(|| Error::usage(format!("--columns {text}"), HELP))?;
        for (to, from) in ranged(to.trim(), from.trim())? {
            if !is_name(&to) {
                let help = format!("names are q1.., dir1.., r31, r32, r33, {}", ORDER.join(", "));
                return Err(Error::usage(format!("--columns {to}=: no such name"), help));
            }
            let place = place(clues, &from)?;
            let same = |p: &Place| (p.file, p.column) == (place.file, place.column);
            if let Some((other, _)) = given.iter().find(|(_, p)| same(p)) {
                let called = clues.tables[place.file].called(place.column);
                let message = format!("--columns: {called} is named twice, as {other} and as {to}");
                return Err(Error::usage(message, HELP));
            }
            if given.contains_key(&to) {
                return Err(Error::usage(format!("--columns: {to} is given twice"), HELP));
            }
            given.insert(to, place);
        }
    }
    Ok(given)
}

/// `q=1-6` as q1=1 .. q6=6, `xyz=7-9` likewise, or the pair itself.
///
/// # Errors
/// A range that runs backwards, and one of other than three columns for x, y, z.
fn ranged(to: &str, from: &str) -> Result<Vec<(String, String)>> {
    let (file, range) = from.split_once(':').map_or((None, from), |(f, r)| (Some(f), r));
    let ends = range.split_once('-').and_then(|(a, b)| {
        Some((a.trim().parse::<usize>().ok()?, b.trim().parse::<usize>().ok()?))
    });
    let names: Vec<String> = match (to, ends) {
        ("q", Some((a, b))) if a <= b => (1..=b - a + 1).map(|j| format!("q{j}")).collect(),
        ("xyz", Some((a, b))) if b == a + 2 => ["x", "y", "z"].map(str::to_owned).to_vec(),
        ("q" | "xyz", Some((a, b))) if a > b => {
            let message = format!("--columns {to}={from}: the range runs backwards");
            return Err(Error::usage(message, format!("write {to}={b}-{a}, or name every column")));
        }
        ("xyz", Some((a, _))) => {
            let message = format!("--columns {to}={from}: x, y and z are three columns");
            return Err(Error::usage(message, format!("such as xyz={a}-{}", a + 2)));
        }
        _ => return Ok(vec![(to.to_owned(), from.to_owned())]),
    };
    let first = ends.map_or(1, |(a, _)| a);
    let column = |i: usize| match file {
        Some(file) => format!("{file}:{}", first + i),
        None => (first + i).to_string(),
    };
    Ok(names.into_iter().enumerate().map(|(i, name)| (name, column(i))).collect())
}

fn place(clues: &Clues, from: &str) -> Result<Place> {
    let by_file =
        from.split_once(':').and_then(|(file, rest)| Some((file.parse::<usize>().ok()?, rest)));
    let (files, name) = match by_file {
        Some((file, rest)) if (1..=clues.tables.len()).contains(&file) => (file - 1..file, rest),
        _ => (0..clues.tables.len(), from),
    };
    for file in files.clone() {
        let table = &clues.tables[file];
        let named = table.headings.iter().position(|h| !h.text.is_empty() && h.text == name);
        let loosely = || {
            table
                .headings
                .iter()
                .position(|h| !h.text.is_empty() && h.text.eq_ignore_ascii_case(name))
        };
        if let Some(column) = named.or_else(loosely) {
            let twin = table.headings.iter().rposition(|h| h.text == table.headings[column].text);
            if let Some(twin) = twin.filter(|twin| *twin != column) {
                let (first, second) = (column + 1, twin + 1);
                return Err(Error::usage(
                    format!("--columns: columns {first} and {second} are both called {name}"),
                    "give the number of the column instead of its heading",
                ));
            }
            return Ok(Place { file, column, because: "it was asked for".to_owned() });
        }
    }
    let number = name.parse::<usize>().ok().filter(|n| *n > 0);
    let file = files.start;
    match number {
        Some(n) if n <= clues.tables[file].headings.len() => {
            Ok(Place { file, column: n - 1, because: "it was asked for".to_owned() })
        }
        _ => {
            let lists: Vec<String> = clues.tables.iter().map(|t| t.list()).collect();
            let help = format!("there are {}; {HELP}", lists.join("; "));
            Err(Error::usage(format!("--columns: no column {from}"), help))
        }
    }
}
