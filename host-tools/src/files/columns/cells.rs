use crate::error::{Error, Result};
use crate::files::source::Source;

/// One row being read.
pub(in crate::files) struct Cells<'a> {
    pub source: Source<'a>,
    pub line: usize,
    /// The byte where the row begins.
    pub start: usize,
    pub names: &'a [String],
    pub record: &'a csv::StringRecord,
}

impl Cells<'_> {
    pub fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or("")
    }

    pub fn fail(&self, column: usize, message: String, help: &str) -> Error {
        let cell = (self.names[column].as_str(), self.source.cell(self.start, column));
        self.source.in_cell(self.line, cell, message, help)
    }

    /// A number, or `None` for an empty cell.
    pub fn optional(&self, column: Option<usize>) -> Result<Option<f64>> {
        let Some(column) = column else { return Ok(None) };
        let text = self.text(column);
        if text.is_empty() {
            return Ok(None);
        }
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            Ok(_) => {
                let message = format!("{text} is not a finite number");
                Err(self.fail(column, message, "delete the row or measure it again"))
            }
            Err(_) => {
                let message = format!("\"{text}\" is not a number");
                Err(self.fail(column, message, "write numbers with a decimal point"))
            }
        }
    }

    pub fn number(&self, column: usize) -> Result<f64> {
        self.optional(Some(column))?.ok_or_else(|| {
            self.fail(column, "empty cell".to_owned(), "fill it in or delete the row")
        })
    }
}
