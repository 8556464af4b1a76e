//! Spreadsheets: .xlsx, .xlsm, .xls, .xlsb and .ods, by calamine.

use std::io::Cursor;
use std::path::Path;

use calamine::{Data, Range, Reader, open_workbook_auto_from_rs};

use super::number::number;
use super::sniff::Line;
use crate::error::{Error, Place, Result};

/// Whether a file is a spreadsheet, by its first bytes: a ZIP archive, or the
/// container that Excel wrote before 2007.
pub(super) fn is_book(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")
}

/// Seconds in a day: spreadsheets count days.
const DAY: f64 = 86_400.0;

/// A sheet as lines, its name, and why it was taken.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    asked: Option<&str>,
) -> Result<(Vec<Line>, String, String)> {
    let fail = |e: calamine::Error| {
        let help = "save it as .xlsx, .ods or CSV without a password";
        Error::file(path, Place::default(), format!("no spreadsheet: {e}"), help)
    };
    let mut book = open_workbook_auto_from_rs(Cursor::new(bytes)).map_err(fail)?;
    let names = book.sheet_names();
    if let Some(name) = asked {
        if !names.iter().any(|n| n == name) {
            let help = format!("--sheet: it has {}", quoted(&names));
            return Err(Error::file(path, Place::default(), format!("no sheet \"{name}\""), help));
        }
        let range = book.worksheet_range(name).map_err(fail)?;
        return Ok((lines(&range), name.to_owned(), "it was asked for".to_owned()));
    }
    let mut found = Vec::new();
    for name in &names {
        let Ok(range) = book.worksheet_range(name) else { continue };
        let lines = lines(&range);
        if lines.iter().filter(|line| numbers(line) >= 2).count() >= 2 {
            found.push((lines, name.clone()));
        }
    }
    match found.len() {
        0 => Err(Error::file(
            path,
            Place::default(),
            format!("no sheet with rows of numbers among {}", quoted(&names)),
            "a table has at least two numbers a row",
        )),
        1 => {
            let because =
                if names.len() == 1 { "it is the only one" } else { "it alone has numbers" };
            Ok(found.remove(0)).map(|(lines, name)| (lines, name, because.to_owned()))
        }
        _ => {
            let names: Vec<String> = found.into_iter().map(|(_, name)| name).collect();
            let help = format!("say which: {}", options("--sheet", &names));
            let message = format!("{} sheets with rows of numbers", names.len());
            Err(Error::file(path, Place::default(), message, help))
        }
    }
}

fn numbers(line: &Line) -> usize {
    line.cells.iter().filter(|c| number(c, '.').or_else(|| number(c, ',')).is_some()).count()
}

fn quoted(names: &[String]) -> String {
    names.iter().map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(", ")
}

fn options(flag: &str, names: &[String]) -> String {
    names.iter().map(|n| format!("{flag} \"{n}\"")).collect::<Vec<_>>().join(" or ")
}

/// Rows of a sheet from its first row on, so that line numbers are those the
/// user sees; empty ones left out.
fn lines(range: &Range<Data>) -> Vec<Line> {
    let (row, column) = range.start().unwrap_or((0, 0));
    let line = |(i, cells): (usize, &[Data])| {
        let blanks = std::iter::repeat_n(String::new(), column as usize);
        let cells: Vec<String> = blanks.chain(cells.iter().map(text)).collect();
        Line { number: row as usize + i + 1, cells }
    };
    let lines = range.rows().enumerate().map(line);
    lines.filter(|line| line.cells.iter().any(|c| !c.is_empty())).collect()
}

fn text(cell: &Data) -> String {
    match cell {
        // A time of day reads as one, so that it goes on after midnight.
        Data::DateTime(days) if days.is_datetime() && (0.0..1.0).contains(&days.as_f64()) => {
            let seconds = days.as_f64() * DAY;
            let (hours, minutes) = ((seconds / 3600.0).floor(), (seconds / 60.0).floor() % 60.0);
            let rest = seconds - 3600.0 * hours - 60.0 * minutes;
            format!("{hours:02}:{minutes:02}:{rest:09.6}")
        }
        // A date reads as one: where a number belongs it is none, as a spreadsheet makes of 1.2.
        Data::DateTime(days) if days.is_datetime() => {
            let (year, month, day, hour, minute, second, milli) = days.to_ymd_hms_milli();
            format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}.{milli:03}")
        }
        Data::DateTime(days) => format!("{}", days.as_f64() * DAY),
        Data::Error(_) | Data::Empty => String::new(),
        other => other.to_string().trim().to_owned(),
    }
}
