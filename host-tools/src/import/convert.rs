//! Tables and what their columns mean, to the text of a measurements.csv.

use std::collections::{BTreeMap, HashSet};

use super::clock::{dated, in_minutes, is_of_day, past_midnight, seconds_beside};
use super::config::{Config, Join, Pick};
use super::join::RowRef;
use super::native::{Own, has_point, own};
use super::number::plain;
use super::table::Table;
use super::turn::{Form, quaternion};
use crate::error::{Error, Result};
use crate::files::csv_text;
use crate::headings::{Quantity, Unit};
use crate::model::near::Reach;

/// Decimals of angles and lengths: 2e-9 rad and 10 nm, finer than any encoder
/// or tracker.
const ANGLE: usize = 7;
const LENGTH: usize = 5;
const OTHER: usize = 9;
/// Rows whose joints agree within this, in degrees or mm, are one pose, as for
/// the reader of measurements.csv.
const SAME: f64 = 0.01;

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

/// One column of measurements.csv.
struct Output<'a> {
    name: String,
    pick: &'a Pick,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// A number that must be there.
    Needed,
    /// The same in rows that measured a point.
    Point,
    /// A number, or nothing.
    Optional,
    Label,
    Time,
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
    let reach = Reach::uniform(config.joints().len(), SAME);
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

/// The columns in their order, orientation apart.
fn outputs(config: &Config) -> Vec<Output<'_>> {
    let output = |(to, pick): (&String, &'_ Pick)| {
        let (name, kind) = match to.as_str() {
            "x" | "y" | "z" => (format!("{to}_mm"), Kind::Point),
            "station" | "marker" | "series" => (to.clone(), Kind::Label),
            "order" => (to.clone(), Kind::Optional),
            "time" => ("time_s".to_owned(), Kind::Time),
            "temperature" => ("temperature_c".to_owned(), Kind::Optional),
            "payload" => ("payload_kg".to_owned(), Kind::Optional),
            "sigma" => ("sigma_mm".to_owned(), Kind::Optional),
            _ if to.starts_with("dir") => (to.clone(), Kind::Optional),
            _ if own(to) == Some(Own::Label) => (to.clone(), Kind::Label),
            _ if own(to) == Some(Own::Number) => (to.clone(), Kind::Optional),
            _ => {
                let length = pick.unit.quantity() == Quantity::Length;
                (format!("{to}_{}", if length { "mm" } else { "deg" }), Kind::Needed)
            }
        };
        (name, kind)
    };
    let orientation = |to: &str| Form::ALL.iter().any(|form| form.columns().contains(&to));
    // A date is a part of the time.
    let columns = config.ordered().into_iter().filter(|(to, _)| !orientation(to) && *to != "date");
    columns
        .map(|(to, pick)| {
            let (name, kind) = output((to, pick));
            Output { name, pick, kind }
        })
        .collect()
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

/// One row being read.
struct Reader<'a> {
    tables: &'a [Table],
    row: &'a RowRef,
    /// Seconds in the session.
    time: Option<f64>,
    /// The column that says the date of a time of day.
    date: Option<&'a Pick>,
    /// The column that says what a row measured.
    kind: Option<&'a Pick>,
}

impl Reader<'_> {
    fn text(&self, pick: &Pick) -> &str {
        let (file, at) = self.row.at(pick.file);
        self.tables[file].text(at, pick.column)
    }

    fn line(&self, pick: &Pick) -> usize {
        let (file, at) = self.row.at(pick.file);
        self.tables[file].rows[at].number
    }

    fn fail(&self, pick: &Pick, message: String, help: &str) -> Error {
        let (file, at) = self.row.at(pick.file);
        self.tables[file].fail(at, pick.column, message, help)
    }

    /// A table without points has no row of one.
    fn has_its_point(&self, config: &Config) -> Result<()> {
        let Some(kind) = self.kind.filter(|_| !config.columns.contains_key("x")) else {
            return Ok(());
        };
        if !has_point(self.text(kind)) {
            return Ok(());
        }
        let message = "a row of a point, but there are no columns x, y, z".to_owned();
        Err(self.fail(kind, message, "say what the row measured, or import without --config"))
    }

    fn missing(&self, output: &Output) -> bool {
        let number = || {
            let (file, at) = self.row.at(output.pick.file);
            self.tables[file].number(at, output.pick.column)
        };
        self.needed(output) && number().is_none()
    }

    fn needed(&self, output: &Output) -> bool {
        match output.kind {
            Kind::Point => self.kind.is_none_or(|pick| has_point(self.text(pick))),
            kind => kind == Kind::Needed,
        }
    }

    /// In the unit of the files; `None` of an empty cell.
    fn number(&self, pick: &Pick) -> Result<Option<f64>> {
        let (file, at) = self.row.at(pick.file);
        let table = &self.tables[file];
        match table.number(at, pick.column) {
            Some(value) => Ok(Some(pick.unit.to_file(value))),
            None if self.text(pick).is_empty() => Ok(None),
            None => {
                let message = format!("\"{}\" is not a number", self.text(pick));
                let help = "mend or delete the row; --skip-incomplete leaves such rows out; --decimal point \
                            or comma says how numbers are written";
                Err(self.fail(pick, message, help))
            }
        }
    }

    fn cell(&self, output: &Output) -> Result<String> {
        let pick = output.pick;
        if output.kind == Kind::Label {
            return Ok(self.text(pick).to_owned());
        }
        if output.kind == Kind::Time {
            if self.time.is_none() && !self.text(pick).is_empty() {
                let message = match self.date {
                    Some(date) => {
                        format!("\"{}\" on \"{}\" is no time", self.text(pick), self.text(date))
                    }
                    None => format!("\"{}\" is no time", self.text(pick)),
                };
                return Err(self.fail(
                    pick,
                    message,
                    "give seconds, 12:03:55 or 2021-03-05 12:03:55; of 03/05/2021 nothing says which is the \
                     month",
                ));
            }
            return Ok(self.time.map_or(String::new(), |time| plain(time, 6)));
        }
        let decimals = match pick.unit.quantity() {
            Quantity::Angle => ANGLE,
            Quantity::Length => LENGTH,
            _ => OTHER,
        };
        match self.number(pick)? {
            Some(value) => Ok(plain(value, decimals)),
            None if !self.needed(output) => Ok(String::new()),
            None => {
                let help = "fill it in or delete the row; --skip-incomplete leaves such rows out";
                Err(self.fail(pick, "empty cell".to_owned(), help))
            }
        }
    }

    /// Quaternion x, y, z, w; empty where any part is.
    fn orientation(&self, form: Form, columns: &BTreeMap<String, Pick>) -> Result<Vec<String>> {
        let picks: Vec<&Pick> = form.columns().iter().filter_map(|c| columns.get(*c)).collect();
        let values = picks.iter().map(|pick| self.number(pick)).collect::<Result<Vec<_>>>()?;
        let Some(values) = values.into_iter().collect::<Option<Vec<f64>>>() else {
            return Ok(vec![String::new(); 4]);
        };
        let scale = |(value, pick): (f64, &&Pick)| {
            if pick.unit.quantity() == Quantity::Angle { value.to_radians() } else { value }
        };
        let values: Vec<f64> = values.into_iter().zip(&picks).map(scale).collect();
        match form.rotation(&values) {
            Some(rotation) => Ok(quaternion(&rotation).iter().map(|v| plain(*v, OTHER)).collect()),
            None => {
                let help = "a quaternion has length 1, a rotation matrix orthogonal rows of length 1; \
                            --orientation none leaves it out";
                Err(self.fail(picks[0], format!("{values:?} is no orientation"), help))
            }
        }
    }
}

/// The unit of labels and plain numbers in a report.
pub(super) fn unit_word(unit: Unit) -> Option<&'static str> {
    (unit != Unit::Plain).then(|| unit.word())
}
