//! What stands between the cells of a text, and which decimal sign they have.

use std::path::Path;

use super::number::{cut, number};
use crate::error::{Error, Place, Result};

/// One line as cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Line {
    /// Counted from 1.
    pub number: usize,
    pub cells: Vec<String>,
}

/// How a text is cut into cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Dialect {
    /// `,`, `;`, a tab, `|`, or a blank for any number of blanks.
    pub delimiter: char,
    /// `.` or `,`.
    pub decimal: char,
}

const DELIMITERS: [char; 5] = [';', '\t', '|', ',', ' '];

impl Dialect {
    /// The word in import.toml and on the command line.
    pub fn delimiter_word(self) -> &'static str {
        match self.delimiter {
            ',' => "comma",
            ';' => "semicolon",
            '\t' => "tab",
            '|' => "bar",
            _ => "blanks",
        }
    }

    /// From that word, or the sign itself.
    pub fn delimiter_of(word: &str) -> Result<char> {
        Ok(match word {
            "comma" | "," => ',',
            "semicolon" | ";" => ';',
            "tab" | "\\t" | "\t" => '\t',
            "bar" | "|" => '|',
            "blanks" | "blank" | "fixed" | " " => ' ',
            _ => {
                let help = "give comma, semicolon, tab, bar or blanks";
                return Err(Error::usage(format!("delimiter \"{word}\""), help));
            }
        })
    }

    /// From the word in import.toml and on the command line.
    pub fn decimal_of(word: &str) -> Result<char> {
        match word {
            "point" | "." => Ok('.'),
            "comma" | "," => Ok(','),
            _ => Err(Error::usage(format!("decimal \"{word}\""), "give point or comma")),
        }
    }

    /// The word for it.
    pub fn decimal_word(self) -> &'static str {
        if self.decimal == ',' { "comma" } else { "point" }
    }

    /// Cuts a text; empty lines are left out.
    pub fn cut(self, path: &Path, text: &str) -> Result<Vec<Line>> {
        if self.delimiter == ' ' {
            let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
            let cells = |line: &str| line.split_whitespace().map(str::to_owned).collect();
            return Ok(lines.map(|(i, line)| Line { number: i + 1, cells: cells(line) }).collect());
        }
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(self.delimiter as u8)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let line = |record: csv::Result<csv::StringRecord>| {
            let record = record.map_err(|e| {
                Error::file(path, Place::default(), e.to_string(), "mend the quotes of the table")
            })?;
            let number = record.position().map_or(0, |p| p.line() as usize);
            Ok(Line { number, cells: record.iter().map(str::to_owned).collect() })
        };
        let blank = |line: &Result<Line>| {
            line.as_ref().is_ok_and(|line| line.cells.iter().all(String::is_empty))
        };
        reader.records().map(line).filter(|line| !blank(line)).collect()
    }
}

/// Lines looked at to find the dialect: enough for any preamble.
const LOOK: usize = 400;

/// Finds the dialect with the most numbers among its cells; what was asked for
/// is settled.
///
/// # Errors
/// A text without rows of numbers, and commas that are both.
pub(super) fn sniff(
    path: &Path,
    text: &str,
    delimiter: Option<char>,
    decimal: Option<char>,
) -> Result<(Dialect, String)> {
    let mut best: Option<(f64, Dialect, usize, usize)> = None;
    let head: String = text.split_inclusive('\n').take(LOOK).collect();
    for d in DELIMITERS.into_iter().filter(|d| delimiter.is_none_or(|asked| asked == *d)) {
        for c in ['.', ','].into_iter().filter(|c| decimal.is_none_or(|asked| asked == *c)) {
            let dialect = Dialect { delimiter: d, decimal: c };
            // Both may be commas where quotes keep them apart.
            if d == ',' && c == ',' && delimiter.is_none() && !head.contains('"') {
                continue;
            }
            let Ok(lines) = dialect.cut(path, &head) else { continue };
            let (score, rows, cells) = worth(&lines, c);
            if score > best.map_or(0.0, |b| b.0) {
                best = Some((score, dialect, rows, cells));
            }
        }
    }
    let (_, dialect, rows, cells) = best.ok_or_else(|| {
        Error::file(
            path,
            Place::default(),
            "no rows of numbers found",
            "a table has at least two numbers a row; --delimiter and --decimal say how it is written",
        )
    })?;
    refuse_double_commas(path, &head, dialect)?;
    let word = dialect.delimiter_word();
    Ok((dialect, format!("{rows} rows are cut into {cells} cells by {word}")))
}

/// Numbers among the cells, times their share; rows and cells of the commonest
/// number of cells.
fn worth(lines: &[Line], decimal: char) -> (f64, usize, usize) {
    let counts = |c: &&String| number(c, decimal).is_some() || cut(c, decimal).is_some();
    let numbers = |line: &Line| line.cells.iter().filter(counts).count();
    let rows: Vec<(usize, usize)> =
        lines.iter().map(|l| (l.cells.len(), numbers(l))).filter(|(_, n)| *n >= 2).collect();
    let width = commonest(rows.iter().map(|(cells, _)| *cells));
    let kept = rows.iter().filter(|(cells, _)| *cells == width);
    let (mut cells, mut found, mut count) = (0, 0, 0);
    for (c, n) in kept {
        (cells, found, count) = (cells + c, found + n, count + 1);
    }
    let share = found as f64 / cells.max(1) as f64;
    (found as f64 * share, count, width)
}

/// The commonest of some numbers, the larger of two.
pub(super) fn commonest(of: impl Iterator<Item = usize>) -> usize {
    let mut counts = std::collections::BTreeMap::new();
    of.for_each(|n| *counts.entry(n).or_insert(0_usize) += 1);
    counts.into_iter().max_by_key(|(n, count)| (*count, *n)).map_or(0, |(n, _)| n)
}

/// `1,5,2,5` under `a,b`: nobody can tell which comma is which.
fn refuse_double_commas(path: &Path, text: &str, dialect: Dialect) -> Result<()> {
    if dialect.delimiter != ',' {
        return Ok(());
    }
    let lines = dialect.cut(path, text)?;
    let data = lines.iter().position(|l| l.cells.iter().all(|c| number(c, '.').is_some()));
    let (Some(data), Some(header)) = (data, data.and_then(|d| d.checked_sub(1))) else {
        return Ok(());
    };
    let (cells, names) = (lines[data].cells.len(), lines[header].cells.len());
    if names >= 3
        && cells > names
        && cells <= 2 * names
        && !lines[header].cells.contains(&String::new())
    {
        return Err(Error::file(
            path,
            Place::line(lines[data].number),
            format!("{cells} cells under {names} headings: commas both between and inside numbers"),
            "export the table with semicolons or tabs between the cells, or with decimal points",
        ));
    }
    Ok(())
}
