//! Tables and what their columns mean, to the text of a measurements.csv.

mod column;
mod row;

use std::collections::{BTreeMap, HashSet};

use super::clock::{dated, in_minutes, is_of_day, past_midnight, seconds_beside};
use super::config::{Config, Join, Pick};
use super::join::RowRef;
use super::table::Table;
use super::turn::Form;
use crate::error::Result;
use crate::files::csv_text;
use crate::headings::Unit;
use crate::model::near::{ONE_POSE, Reach};
use column::outputs;
use row::Reader;

/// What became of the tables.
pub(super) struct Converted {
    pub csv: String,
    pub rows: usize,
    pub poses: usize,
    /// Lines left out because cells are missing.
    pub incomplete: Vec<usize>,
    /// How often the time of a row is before that of the row before.
    pub back: usize,
}

impl Converted {
    /// What is to be said of rows and their times.
    pub fn remarks(&self) -> Vec<String> {
        let mut out = Vec::new();
        if !self.incomplete.is_empty() {
            let lines: Vec<String> = self.incomplete.iter().map(usize::to_string).collect();
            out.push(format!("rows left out for missing cells, lines {}", lines.join(", ")));
        }
        if self.back > 0 {
            out.push(format!(
                "times go back {} times in the order of the rows, as of several days, or of files that \
                 begin anew: rows are followed in the order of their times. Give dates, or times that \
                 go on; without the column rows are followed as they stand",
                self.back
            ));
        }
        out
    }
}

/// Converts all rows.
///
/// # Errors
/// Names file, line and column of what is missing or no number.
pub(super) fn convert(
    tables: &[Table],
    config: &Config,
    rows: &[RowRef],
    skip_incomplete: bool,
) -> Result<Converted> {
    let outputs = outputs(config);
    let form = form(&config.columns);
    let stacked = config.join == Join::Stack && !config.columns.contains_key("series");
    let mut header: Vec<String> = outputs.iter().map(|o| o.name.clone()).collect();
    header.extend(stacked.then(|| "series".to_owned()));
    header.extend(
        form.iter().flat_map(|_| Form::Quaternion.columns().iter().map(|c| (*c).to_owned())),
    );
    let names = series(tables);
    let times = times(tables, config, rows);
    let known: Vec<f64> = times.iter().flatten().copied().collect();
    let back = known.windows(2).filter(|pair| pair[1] < pair[0]).count();
    let (mut lines, mut joints, mut incomplete) = (Vec::new(), Vec::new(), Vec::new());
    for (row, time) in rows.iter().zip(times) {
        let (date, kind) = (config.columns.get("date"), config.columns.get("kind"));
        let reader = Reader { tables, row, time, date, kind };
        reader.has_its_point(config)?;
        let cells = outputs.iter().map(|o| reader.cell(o)).collect::<Result<Vec<String>>>();
        let cells = match cells {
            Err(_) if skip_incomplete && outputs.iter().any(|o| reader.missing(o)) => {
                incomplete.push(reader.line(outputs[0].pick));
                continue;
            }
            other => other?,
        };
        let mut cells = cells;
        cells.extend(stacked.then(|| names[row.stacked.unwrap_or(0)].clone()));
        if let Some(form) = form {
            cells.extend(reader.orientation(form, &config.columns)?);
        }
        let count = config.joints().len();
        joints.push(cells[..count].iter().filter_map(|c| c.parse().ok()).collect::<Vec<f64>>());
        lines.push(cells);
    }
    let count = lines.len();
    let reach = Reach::uniform(config.joints().len(), ONE_POSE);
    let poses = reach.number(joints.iter().map(Vec::as_slice)).1;
    let csv = csv_text(header.iter().map(String::as_str), lines);
    Ok(Converted { csv, rows: count, poses, incomplete, back })
}

/// A label a file: its name, with as many of its folders as tell it from all others.
fn series(tables: &[Table]) -> Vec<String> {
    let parts = |table: &Table| -> Vec<String> {
        let path = table.path.with_extension("");
        path.iter().map(|part| part.to_string_lossy().into_owned()).collect()
    };
    let all: Vec<Vec<String>> = tables.iter().map(parts).collect();
    let most = all.iter().map(Vec::len).max().unwrap_or(1);
    let of = |depth: usize| -> Vec<String> {
        all.iter().map(|parts| parts[parts.len().saturating_sub(depth)..].join("/")).collect()
    };
    let told = |names: &Vec<String>| names.iter().collect::<HashSet<_>>().len() == names.len();
    (1..=most).map(of).find(told).unwrap_or_else(|| of(1))
}

/// The form whose columns are all there.
fn form(columns: &BTreeMap<String, Pick>) -> Option<Form> {
    Form::ALL.into_iter().find(|f| f.columns().iter().all(|c| columns.contains_key(*c)))
}

/// Seconds of every row; from the first on, if they are dates or times of day.
fn times(tables: &[Table], config: &Config, rows: &[RowRef]) -> Vec<Option<f64>> {
    let Some(pick) = config.columns.get("time") else { return vec![None; rows.len()] };
    let reader = |row| Reader { tables, row, time: None, date: None, kind: None };
    let minutes_first = rows.iter().any(|row| in_minutes(reader(row).text(pick)));
    let date = config.columns.get("date");
    let time = |row| {
        let reader = reader(row);
        let text = reader.text(pick);
        let number = reader.number(pick).ok().flatten();
        number.or_else(|| match date {
            Some(date) => dated(reader.text(date), text),
            None => seconds_beside(text, minutes_first),
        })
    };
    let mut times: Vec<Option<f64>> = rows.iter().map(time).collect();
    let text = |row: &RowRef| {
        let (file, at) = row.at(pick.file);
        tables[file].number(at, pick.column).is_none()
    };
    let mut said = rows.iter().filter(|row| !reader(row).text(pick).is_empty());
    if date.is_none() && said.all(|row| text(row) && is_of_day(reader(row).text(pick))) {
        past_midnight(&mut times);
    }
    let least = times.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    // More seconds than a session has: a date.
    if least.is_finite() && (rows.first().is_some_and(text) || least > 1e8) {
        times.iter_mut().flatten().for_each(|time| *time -= least);
    }
    times
}

/// The unit of labels and plain numbers in a report.
pub(super) fn unit_word(unit: Unit) -> Option<&'static str> {
    (unit != Unit::Plain).then(|| unit.word())
}
