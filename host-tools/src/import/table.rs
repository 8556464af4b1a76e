//! A file as a table: headings, rows, and what is known of how it was written.

use std::path::{Path, PathBuf};

use super::config::FileConfig;
use super::number::number;
use super::sniff::{Dialect, Line, sniff};
use super::{decode, fixed, layout, spreadsheet, suffix};
use crate::error::{Error, Place, Result, listed};
use crate::headings::{Heading, Unit};

/// A table that was read.
pub(super) struct Table {
    pub path: PathBuf,
    /// One a column; their texts are empty where the file has no headings.
    pub headings: Vec<Heading>,
    pub rows: Vec<Line>,
    pub decimal: char,
    /// How it was read, so that the next run reads it likewise.
    pub settled: FileConfig,
    /// Why so, a line each.
    pub evidence: Vec<String>,
    pub warnings: Vec<String>,
    /// Units that remarks above the table say, and in which line.
    pub remarked: Vec<(Unit, usize)>,
}

/// A column is one of numbers if so many of its cells are: a few may be missing.
const MOSTLY: f64 = 0.8;

impl Table {
    /// Reads a file; what `asked` holds is settled, the rest is found.
    ///
    /// # Errors
    /// What is no table, by name, and what to do with it.
    pub fn read(path: &Path, asked: &FileConfig) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        let mut settled = FileConfig { file: path.display().to_string(), ..asked.clone() };
        let mut evidence = Vec::new();
        let (lines, dialect, layout, units);
        if spreadsheet::is_book(&bytes) {
            let (mut found, sheet, because) =
                spreadsheet::read(path, &bytes, asked.sheet.as_deref())?;
            evidence.push(format!("sheet \"{sheet}\": {because}"));
            settled.sheet = Some(sheet);
            let decimal = asked.decimal.as_deref().map(Dialect::decimal_of).transpose()?;
            dialect = Dialect { delimiter: ',', decimal: decimal.unwrap_or(sheet_decimal(&found)) };
            units = suffix::taken_out(path, &mut found, dialect.decimal)?;
            layout = lines_of(path, &found, dialect, asked)?;
            lines = found;
        } else {
            let decoded = decode::decode(path, &bytes, asked.encoding.as_deref())?;
            evidence.push(format!("encoding {}: {}", decoded.encoding, decoded.because));
            settled.encoding = Some(decoded.encoding);
            refuse_toml(path, &decoded.text)?;
            let delimiter = asked.delimiter.as_deref().map(Dialect::delimiter_of).transpose()?;
            let decimal = asked.decimal.as_deref().map(Dialect::decimal_of).transpose()?;
            let because;
            (dialect, because) = sniff(path, &decoded.text, delimiter, decimal)?;
            evidence.push(because);
            settled.delimiter = Some(dialect.delimiter_word().to_owned());
            let mut cut = dialect.cut(path, &decoded.text)?;
            // Where blanks cut, a unit is a cell of its own.
            let blanks = dialect.delimiter == ' ';
            let whole = if blanks { &mut [] } else { cut.as_mut_slice() };
            units = suffix::taken_out(path, whole, dialect.decimal)?;
            layout = lines_of(path, &cut, dialect, asked)?;
            let by_place =
                (dialect.delimiter == ' ').then(|| fixed::cut(&decoded.text, &cut, layout));
            lines = match by_place.flatten() {
                Some(lines) => {
                    evidence.push("fixed columns: blanks alone do not tell empty cells".to_owned());
                    lines
                }
                None => cut,
            };
        }
        settled.decimal = Some(dialect.decimal_word().to_owned());
        settled.header_line = Some(layout.header.unwrap_or(0));
        settled.unit_line = layout.units;
        settled.data_line = Some(layout.data);
        let mut body = layout::body(path, lines, layout, dialect.decimal)?;
        suffix::told(path, &mut body.headings, &units)?;
        Ok(Self {
            path: path.to_owned(),
            headings: body.headings,
            rows: body.rows,
            decimal: dialect.decimal,
            settled,
            evidence,
            warnings: body.warnings,
            remarked: body.remarked,
        })
    }

    /// Whether it has headings.
    pub fn named(&self) -> bool {
        self.headings.iter().any(|h| !h.text.is_empty())
    }

    /// A number of a row, `None` where there is none.
    pub fn number(&self, row: usize, column: usize) -> Option<f64> {
        number(self.text(row, column), self.decimal).filter(|x| x.is_finite())
    }

    /// A cell.
    pub fn text(&self, row: usize, column: usize) -> &str {
        self.rows.get(row).and_then(|r| r.cells.get(column)).map_or("", String::as_str)
    }

    /// The numbers of a column.
    pub fn numbers(&self, column: usize) -> Vec<f64> {
        (0..self.rows.len()).filter_map(|row| self.number(row, column)).collect()
    }

    /// Whether a column is one of numbers.
    pub fn numeric(&self, column: usize) -> bool {
        let filled = (0..self.rows.len()).filter(|r| !self.text(*r, column).is_empty()).count();
        let found = self.numbers(column).len();
        filled > 0 && found as f64 >= MOSTLY * filled as f64
    }

    /// Largest magnitude in a column.
    pub fn most(&self, column: usize) -> f64 {
        self.numbers(column).iter().fold(0.0, |most, x| x.abs().max(most))
    }

    /// Largest less smallest value of a column.
    pub fn range(&self, column: usize) -> f64 {
        let all = self.numbers(column);
        let most = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        if all.is_empty() { 0.0 } else { most - least }
    }

    /// `column 3 "J1"`, for people.
    pub fn called(&self, column: usize) -> String {
        match self.headings.get(column).map(|h| h.text.as_str()) {
            Some(name) if !name.is_empty() => format!("column {} \"{name}\"", column + 1),
            _ => format!("column {}", column + 1),
        }
    }

    /// All headings, for a message.
    pub fn list(&self) -> String {
        if !self.named() {
            return format!("{} columns without headings", self.headings.len());
        }
        let names: Vec<&str> = self.headings.iter().map(|h| h.text.as_str()).collect();
        listed(&names)
    }

    /// What is wrong in a cell.
    pub fn fail(&self, row: usize, column: usize, message: String, help: &str) -> Error {
        let line = self.rows.get(row).map_or(0, |r| r.number);
        let name = match self.headings.get(column).map(|h| h.text.as_str()) {
            Some(name) if !name.is_empty() => name.to_owned(),
            _ => (column + 1).to_string(),
        };
        Error::file(&self.path, Place::field(line, &name), message, help)
    }
}

/// The decimal sign of numbers that a sheet holds as texts.
fn sheet_decimal(lines: &[Line]) -> char {
    let count = |decimal| {
        let cells = lines.iter().flat_map(|l| &l.cells);
        cells.filter(|c| number(c, decimal).is_some()).count()
    };
    if count(',') > count('.') { ',' } else { '.' }
}

/// Where the table begins, as asked or as found.
fn lines_of(
    path: &Path,
    lines: &[Line],
    dialect: Dialect,
    asked: &FileConfig,
) -> Result<layout::Layout> {
    let mut found = layout::find(path, lines, dialect.decimal, asked.header_line)?;
    if let Some(data) = asked.data_line {
        found.data = data;
        found.units = asked.unit_line;
    }
    Ok(found)
}

/// A robot.toml, model.toml or import.toml where a table belongs.
fn refuse_toml(path: &Path, text: &str) -> Result<()> {
    let tables = ["[[joints]]", "[[files]]", "[tool]", "joints = ["];
    let found = text.lines().any(|line| tables.iter().any(|t| line.trim().starts_with(t)));
    let toml = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    if !found && !toml {
        return Ok(());
    }
    let help = "give the measured table as FILE, an arm with --robot, what an earlier import settled \
                with --config";
    Err(Error::file(path, Place::default(), "a TOML file, not a table", help))
}
