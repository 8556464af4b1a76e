use crate::error::{Error, Result};
use crate::files::source::Source;
use crate::headings::{Heading, Unit};

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

    /// Whether the row is one of units; they must be those of the columns.
    pub fn unit_row(&self) -> Result<bool> {
        let filled = (0..self.record.len()).filter(|c| !self.text(*c).is_empty());
        let units: Vec<_> = filled.map(|c| (c, Unit::of_word(self.text(c)))).collect();
        let known = |unit: &Option<Unit>| unit.is_some_and(|u| u != Unit::Plain);
        if !units.iter().any(|(_, u)| known(u)) || units.iter().any(|(_, u)| u.is_none()) {
            return Ok(false);
        }
        for (column, unit) in units.iter().filter(|(_, u)| known(u)) {
            let own = Heading::new(&self.names[*column]).unit;
            if own.is_some() && own != *unit {
                let (name, text) = (&self.names[*column], self.text(*column));
                let message = format!("unit \"{text}\" under the heading {name}");
                let help =
                    "`truearm import` converts units; delete the row if the heading is right";
                return Err(self.fail(*column, message, help));
            }
        }
        Ok(true)
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
