//! A file being read: what is wrong in it is shown where it stands.

use std::ops::Range;
use std::path::Path;

use serde::de::DeserializeOwned;

use crate::error::{Error, Place, Result};

/// Name and text of a file.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub path: &'a Path,
    pub text: &'a str,
}

impl Source<'_> {
    /// What is wrong at a part of the text.
    pub fn at(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Error {
        let place = Place::offset(self.text, span.start);
        Error::file(self.path, place, message, help).showing(self.text, span)
    }

    /// What is wrong with the file as a whole.
    pub fn whole(&self, message: impl Into<String>, help: impl Into<String>) -> Error {
        Error::file(self.path, Place::default(), message, help)
    }

    /// The line of a byte, counted from 1.
    pub fn line(&self, offset: usize) -> usize {
        Place::offset(self.text, offset).line.unwrap_or(0)
    }

    /// The byte where a line begins.
    pub fn start_of(&self, line: usize) -> usize {
        let lines = self.text.split_inclusive('\n');
        lines.take(line.saturating_sub(1)).map(str::len).sum()
    }

    /// Reads TOML into `F`; unknown keys become warnings.
    pub fn toml<F: DeserializeOwned>(&self, help: &str, warnings: &mut Vec<String>) -> Result<F> {
        let fail = |e: toml::de::Error| match e.span() {
            Some(span) => self.at(span, e.message(), help),
            None => self.whole(e.message(), help),
        };
        let deserializer = toml::Deserializer::parse(self.text).map_err(fail)?;
        serde_ignored::deserialize(deserializer, |key| {
            warnings.push(format!("{}: unknown key `{key}` ignored", self.path.display()));
        })
        .map_err(fail)
    }

    /// The bytes of a cell, without blanks around it, of the CSV record that
    /// begins at a byte; of its last cell if there are fewer.
    pub fn cell(&self, record: usize, column: usize) -> Range<usize> {
        let bytes = self.text.as_bytes();
        let blank = |at: &usize| matches!(bytes.get(*at), Some(b'\n' | b'\r'));
        let mut at = (record..).find(|at| !blank(at)).unwrap_or(record);
        let (mut begin, mut seen, mut quoted) = (at, 0, false);
        while let Some(byte) = bytes.get(at) {
            match byte {
                b'"' => quoted = !quoted,
                b'\n' if !quoted => break,
                b',' if !quoted && seen == column => break,
                b',' if !quoted => (seen, begin) = (seen + 1, at + 1),
                _ => {}
            }
            at += 1;
        }
        let cell = self.text.get(begin..at).unwrap_or("");
        let begin = begin + cell.len() - cell.trim_start().len();
        begin..begin + cell.trim().len()
    }

    /// What is wrong in a named cell of a line.
    pub fn in_cell(
        &self,
        line: usize,
        (name, span): (&str, Range<usize>),
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Error {
        Error::file(self.path, Place::field(line, name), message, help).showing(self.text, span)
    }

    /// What is wrong with a line that begins at a byte.
    pub fn in_line(
        &self,
        line: usize,
        start: usize,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Error {
        let rest = self.text.get(start..).unwrap_or("");
        let begin = start + rest.len() - rest.trim_start_matches(['\r', '\n']).len();
        let length = self.text.get(begin..).and_then(|t| t.lines().next()).map_or(0, str::len);
        Error::file(self.path, Place::line(line), message, help)
            .showing(self.text, begin..begin + length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found() {
        let text = "a, b ,\"c,\n\"\"d\"\"\"\n\n1,2,3\n";
        let source = Source { path: Path::new("m.csv"), text };
        let cells = [(0, 0, "a"), (0, 1, "b"), (0, 2, "\"c,\n\"\"d\"\"\"")];
        for (record, column, cell) in [cells.as_slice(), &[(17, 1, "2"), (17, 7, "3")]].concat() {
            assert_eq!(&text[source.cell(record, column)], cell);
        }
    }
}
