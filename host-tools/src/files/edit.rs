//! Changing cells of a user's CSV file, or tables of a TOML file, and nothing else:
//! other cells, comments, blanks, quotes and line ends stay as they are.

use std::ops::Range;
use std::path::Path;

use toml_edit::{DocumentMut, Item, TableLike, Value};

use super::source::Source;
use crate::error::{Error, ErrorKind, Place, Result};

/// A CSV file whose cells can be changed.
pub struct CsvEdit<'a> {
    text: &'a str,
    header: Vec<String>,
    rows: Vec<EditedRow>,
}

struct EditedRow {
    spans: Vec<Range<usize>>,
    cells: Vec<String>,
    dropped: bool,
}

impl<'a> CsvEdit<'a> {
    /// Of a text that [`Measurements::parse`](crate::model::Measurements::parse)
    /// took.
    ///
    /// # Errors
    /// A text that is no CSV.
    pub fn new(path: &Path, text: &'a str) -> Result<Self> {
        let source = Source { path, text };
        let wrong = |e: csv::Error| {
            Error::file(path, Place::default(), e.to_string(), "write one row a measurement")
        };
        let mut reader = super::csv_reader(text, true);
        let header = reader.headers().map_err(wrong)?.iter().map(str::to_owned).collect();
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(wrong)?;
            // A row of units under the header measures nothing.
            if rows.is_empty() && record.iter().all(|cell| cell.parse::<f64>().is_err()) {
                continue;
            }
            let start = record.position().map_or(0, |p| p.byte() as usize);
            rows.push(EditedRow {
                spans: source.cells(start, record.len()),
                cells: record.iter().map(str::to_owned).collect(),
                dropped: false,
            });
        }
        Ok(Self { text, header, rows })
    }

    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Where a column stands.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|known| known == name)
    }

    /// A cell; empty where there is none.
    #[must_use]
    pub fn cell(&self, row: usize, column: usize) -> &str {
        self.rows.get(row).and_then(|row| row.cells.get(column)).map_or("", String::as_str)
    }

    /// Another text in a cell.
    pub fn set(&mut self, row: usize, column: usize, text: impl Into<String>) {
        if let Some(cell) = self.rows.get_mut(row).and_then(|row| row.cells.get_mut(column)) {
            *cell = text.into();
        }
    }

    /// Leaves a row out.
    pub fn drop_row(&mut self, row: usize) {
        if let Some(row) = self.rows.get_mut(row) {
            row.dropped = true;
        }
    }

    /// The whole text as it is now.
    #[must_use]
    pub fn finish(&self) -> String {
        let mut out = String::with_capacity(self.text.len());
        let mut at = 0;
        for row in &self.rows {
            let line = |at: usize| self.text[..at].rfind('\n').map_or(0, |end| end + 1);
            let (Some(first), Some(last)) = (row.spans.first(), row.spans.last()) else { continue };
            if row.dropped {
                out += &self.text[at..line(first.start)];
                at = self.text[last.end..].find('\n').map_or(self.text.len(), |n| last.end + n + 1);
                continue;
            }
            for (span, cell) in row.spans.iter().zip(&row.cells) {
                let stood = &self.text[span.clone()];
                out += &self.text[at..span.start];
                out += if stood.trim_matches('"').trim() == cell { stood } else { cell };
                at = span.end;
            }
        }
        out + &self.text[at..]
    }
}

/// A text to be edited is not what was read from the file.
pub(crate) fn not_that_text(path: &Path) -> Error {
    let message = format!("{}: not the text that was read", path.display());
    Error::data(ErrorKind::File, message, "the file changed in between: try again")
}

/// `[[joints]]`, `joints = [{..}]`, or one table such as `[payload]`.
pub(crate) fn tables<'a>(document: &'a mut DocumentMut, key: &str) -> Vec<&'a mut dyn TableLike> {
    match document.get_mut(key) {
        Some(Item::ArrayOfTables(tables)) => {
            tables.iter_mut().map(|table| table as &mut dyn TableLike).collect()
        }
        Some(Item::Value(Value::Array(array))) => {
            let tables = array.iter_mut().filter_map(Value::as_inline_table_mut);
            tables.map(|table| table as &mut dyn TableLike).collect()
        }
        Some(item) => item.as_table_like_mut().into_iter().collect(),
        None => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_else_changes() {
        let text = "# by hand\r\na, b ,\"c\"\r\ndeg,mm,\r\n1, 2.50 ,\"x, y\"\r\n# break\r\n\r\n3,4,5\r\n6,7,8";
        let mut edit = CsvEdit::new(Path::new("m.csv"), text).unwrap();
        assert_eq!(edit.finish(), text);
        assert_eq!((edit.rows(), edit.column("c"), edit.cell(0, 2)), (3, Some(2), "x, y"));
        edit.set(0, 1, "-2.50");
        edit.set(2, 0, "9");
        edit.drop_row(1);
        let now =
            "# by hand\r\na, b ,\"c\"\r\ndeg,mm,\r\n1, -2.50 ,\"x, y\"\r\n# break\r\n\r\n9,7,8";
        assert_eq!(edit.finish(), now);
        edit.drop_row(2);
        assert!(edit.finish().ends_with("# break\r\n\r\n"));
    }
}
