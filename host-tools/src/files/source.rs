//! A file being read: what is wrong in it is shown where it stands.

use std::ops::Range;
use std::path::Path;

use serde::de::DeserializeOwned;

use crate::error::{Error, Place, Result};

/// What to do about one file in the place of the other.
const SWAPPED: &str = "are the arguments swapped? The arm (robot.toml or model.toml) stands before \
                       the measurements";

/// Keys of robot.toml, for those that resemble one.
const KEYS: [&str; 29] = [
    "name",
    "serial",
    "measurement_sigma_mm",
    "measurement_sigma_deg",
    "gravity_m_s2",
    "reference_temperature_c",
    "joints",
    "base",
    "tool",
    "links",
    "payload",
    "kind",
    "alpha_deg",
    "a_mm",
    "d_mm",
    "d_offset_mm",
    "theta_offset_deg",
    "beta_deg",
    "limits_deg",
    "limits_mm",
    "gear_ratio",
    "tolerance",
    "expected",
    "xyz_mm",
    "rpy_deg",
    "mass_kg",
    "com_mm",
    "corrections",
    "markers",
];

/// The name among `known` that is most like a word, if it is near enough to be
/// a slip of the keyboard, a word short, or another unit.
pub(super) fn resembling<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let like = |name: &str| strsim::jaro_winkler(&word, name);
    // 0.85 takes `alfa_deg`, `gear_ration`, `alpha`, `d_m`; not `colour`.
    let near = known.map(|name| (name, like(name))).filter(|(_, like)| *like >= 0.85);
    near.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(name, _)| name)
}

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

    /// Refuses a table where a TOML file belongs.
    pub fn refuse_table(&self) -> Result<()> {
        let lines = self.text.lines().map(str::trim);
        let mut lines = lines.filter(|l| !l.is_empty() && !l.starts_with('#'));
        let table = |line: &str| {
            let toml = line.contains('=') || line.starts_with('[');
            !toml && line.split([',', ';', '\t']).count() >= 3
        };
        match (lines.next(), lines.next()) {
            (Some(a), Some(b)) if table(a) && table(b) => {
                Err(self.whole("a table, not a TOML file", SWAPPED))
            }
            _ => Ok(()),
        }
    }

    /// Refuses a TOML file where a table belongs.
    pub fn refuse_toml(&self) -> Result<()> {
        const BEGIN: [&str; 5] = ["[[", "[tool]", "[base]", "joints = [", "joints=["];
        let toml = |line: &str| BEGIN.iter().any(|begin| line.trim().starts_with(begin));
        if !self.text.lines().any(toml) {
            return Ok(());
        }
        Err(self.whole("a TOML file, not a table of measurements", SWAPPED))
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

    /// The warning of a key that is not looked at and resembles no other.
    pub fn unknown(&self, key: &str) -> String {
        format!("{}: unknown key `{key}` ignored", self.path.display())
    }

    /// Reads TOML into `F`; unknown keys become warnings.
    pub fn toml<F: DeserializeOwned>(&self, help: &str, warnings: &mut Vec<String>) -> Result<F> {
        let fail = |e: toml::de::Error, help: &str| match e.span() {
            Some(span) => self.at(span, e.message(), help),
            None => self.whole(e.message(), help),
        };
        let deserializer = toml::Deserializer::parse(self.text).map_err(|e| fail(e, help))?;
        let (mut unknown, mut slips) = (Vec::new(), Vec::new());
        let read = serde_ignored::deserialize(deserializer, |key| {
            // Spans are kept in a struct of their own, which no user wrote.
            let key = key.to_string().replace(".$__serde_spanned_private_value", "");
            // Nor did one write that a table may be left out.
            let key = key.replace(".?", "");
            let name = key.rsplit('.').next().unwrap_or(&key);
            // A key that is right elsewhere is no slip.
            let like = resembling(name, KEYS.iter().copied()).filter(|like| *like != name);
            let remark = match like {
                Some(like) => format!("{}; is `{like}` meant?", self.unknown(&key)),
                None => self.unknown(&key),
            };
            let slip = |like| format!("unknown key `{key}` ignored; is `{like}` meant?");
            slips.extend(like.map(slip));
            unknown.push(remark);
        });
        warnings.extend(unknown);
        // A key that is missing may be there under another name.
        read.map_err(|e| match &slips[..] {
            [] => fail(e, help),
            _ => fail(e, &format!("{}; {help}", slips.join("; "))),
        })
    }

    /// The headings of a table: those of its first line that is no remark.
    pub fn headings(&self) -> Vec<String> {
        let mut reader = super::csv_reader(self.text, true);
        let headings = reader.headers().map(|names| names.iter().map(str::to_owned).collect());
        headings.unwrap_or_default()
    }

    /// What is wrong with the headings of a table.
    pub fn in_headings(&self, message: impl Into<String>, help: impl Into<String>) -> Error {
        let (line, start) = self.begin(1, 0);
        self.in_line(line, start, message, help)
    }

    /// Line and byte where the first CSV record from these on begins: behind
    /// empty lines and comments.
    pub fn begin(&self, line: usize, byte: usize) -> (usize, usize) {
        let (mut line, mut at) = (line, byte);
        for text in self.text.get(byte..).unwrap_or("").split_inclusive('\n') {
            let empty = text.trim_end_matches(['\r', '\n']).is_empty();
            if !empty && !text.starts_with('#') {
                break;
            }
            (line, at) = (line + 1, at + text.len());
        }
        (line, at)
    }

    /// The bytes of a cell, without blanks around it, of the CSV record that
    /// begins at a byte; of its last cell if there are fewer.
    pub fn cell(&self, record: usize, column: usize) -> Range<usize> {
        let bytes = self.text.as_bytes();
        let (_, mut at) = self.begin(0, record);
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

    /// The bytes of all cells of a CSV record of so many, as [`Source::cell`] has
    /// them, in one pass.
    pub fn cells(&self, record: usize, count: usize) -> Vec<Range<usize>> {
        let bytes = self.text.as_bytes();
        let (_, mut at) = self.begin(0, record);
        let (mut begin, mut quoted, mut cells) = (at, false, Vec::with_capacity(count));
        let bare = |begin: usize, end: usize| {
            let cell = self.text.get(begin..end).unwrap_or("");
            let begin = begin + cell.len() - cell.trim_start().len();
            begin..begin + cell.trim().len()
        };
        while let Some(byte) = bytes.get(at) {
            match byte {
                b'"' => quoted = !quoted,
                b'\n' if !quoted => break,
                b',' if !quoted => {
                    cells.push(bare(begin, at));
                    begin = at + 1;
                }
                _ => {}
            }
            at += 1;
        }
        cells.push(bare(begin, at));
        // Of a record with fewer cells the last one stands for the rest.
        let last = cells.last().cloned().unwrap_or(at..at);
        cells.resize(count, last);
        cells
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
        let (_, begin) = self.begin(line, start);
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
            assert_eq!(source.cells(record, column + 1)[column], source.cell(record, column));
        }
    }
}
