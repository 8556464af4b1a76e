use crate::error::{Error, Place, Result};
use crate::files::source::Source;
use crate::headings::{Heading, Unit};

/// The cells of a row, as the format of its file has them.
pub(in crate::files) trait Record {
    /// What stands in a cell; empty where there is none.
    fn text(&self, column: usize) -> &str;

    /// The number in a cell that is not empty; what stands there in its place.
    fn number(&self, column: usize) -> std::result::Result<Option<f64>, &str> {
        number(self.text(column))
    }
}

/// The number that a text is; `None` of an empty one.
pub(in crate::files) fn number(text: &str) -> std::result::Result<Option<f64>, &str> {
    match text {
        "" => Ok(None),
        text => text.parse().map(Some).map_err(|_| text),
    }
}

impl Record for csv::StringRecord {
    fn text(&self, column: usize) -> &str {
        self.get(column).unwrap_or("")
    }
}

/// One row being read.
pub(in crate::files) struct Cells<'a> {
    pub source: Source<'a>,
    /// The line, or in a file without lines the row, counted from 1.
    pub line: usize,
    /// The byte where the row begins; `None` in a file that is no text.
    pub start: Option<usize>,
    pub names: &'a [String],
    pub record: &'a dyn Record,
}

impl Cells<'_> {
    pub fn text(&self, column: usize) -> &str {
        self.record.text(column)
    }

    pub fn fail(&self, column: usize, message: String, help: &str) -> Error {
        let name = self.names[column].as_str();
        match self.start {
            Some(start) => {
                let cell = (name, self.source.cell(start, column));
                self.source.in_cell(self.line, cell, message, help)
            }
            None => Error::file(self.source.path, Place::field(self.line, name), message, help),
        }
    }

    /// What is wrong with the row as a whole.
    pub fn fail_whole(&self, message: impl Into<String>, help: impl Into<String>) -> Error {
        match self.start {
            Some(start) => self.source.in_line(self.line, start, message, help),
            None => Error::file(self.source.path, Place::line(self.line), message, help),
        }
    }

    /// Whether the row is one of units; they must be those of the columns.
    pub fn unit_row(&self) -> Result<bool> {
        let filled = (0..self.names.len()).filter(|c| !self.text(*c).is_empty());
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
        match self.record.number(column) {
            Ok(Some(value)) if !value.is_finite() => {
                let message = format!("{} is not a finite number", self.text(column));
                Err(self.fail(column, message, "delete the row or measure it again"))
            }
            Ok(value) => Ok(value),
            Err(text) => {
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
