//! What can go wrong, said so that the user knows where and what to do, and of a
//! kind, so that a program can ask which it is.

use std::ops::Range;
use std::path::{Path, PathBuf};

/// Kinds of errors. The words are beside it and may change; the kind does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Kind {
    /// A file that could not be read or written.
    Io,
    /// Something wrong in a file the user wrote.
    File,
    /// A command line whose values make no sense.
    Usage,
    /// A file without rows, or nothing left to judge.
    NoRows,
    /// Fewer equations than unknowns, or a single pose.
    TooFewPoses,
    /// A number that became infinite, or none: nothing is written.
    NotFinite,
    /// Points too few, or on a line, so that a frame is undetermined.
    FrameUndetermined,
    /// A tracker station that the model does not know.
    UnknownStation,
    /// A marker that the model does not know.
    UnknownMarker,
    /// An iteration that did not come to rest.
    NotConverged,
    /// Equations without a unique solution.
    Singular,
    /// More rows contradict the others than errors of single rows can be.
    Contradiction,
    /// Poses asked for that the arm, the region or the limits do not allow.
    NoPoses,
    /// A goal that was not reached; what was reached is there.
    GoalMissed,
    /// A diagnosis that names no alternative.
    NoAlternative,
    /// A blob, or a model that would become one, that a controller refuses.
    Refused,
    /// Two blobs, or a blob and a robot, that are not of one arm.
    OtherArm,
    /// More terms of the arm than a controller takes.
    TooManyTerms,
    /// A model without the covariance, or with that of another.
    NoCovariance,
    /// A slot of the controller that is too small or was not named.
    NoSlot,
}

/// What has a frame of its own and a label in the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Label {
    /// A placement of the tracker.
    Station,
    /// A target on the arm.
    Marker,
}

impl Label {
    /// As the column is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Station => "station",
            Self::Marker => "marker",
        }
    }

    /// The kind of error where it is not known.
    #[must_use]
    pub fn unknown(self) -> Kind {
        match self {
            Self::Station => Kind::UnknownStation,
            Self::Marker => Kind::UnknownMarker,
        }
    }
}

/// An error of the library. `Display` is one line; [`Error::help`] says what to
/// do, [`Error::kind`] what it is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file that could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Something wrong in a file the user wrote.
    #[error("{}{place}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Box<Place>,
        /// What is wrong there.
        message: String,
        /// What to do about it.
        help: String,
        /// The text and the part of it that is meant, where they are known.
        excerpt: Option<Box<Excerpt>>,
    },
    /// A command line whose values make no sense.
    #[error("{message}")]
    Usage {
        /// What is wrong.
        message: String,
        /// What to do about it.
        help: String,
    },
    /// Data that cannot answer what was asked of them.
    #[error("{message}")]
    Data {
        /// Which kind.
        kind: Kind,
        /// What is wrong.
        message: String,
        /// What to do about it.
        help: String,
    },
}

/// The text of a file and the part of it that is meant, in bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excerpt {
    /// The whole text.
    pub text: String,
    /// The part.
    pub span: Range<usize>,
}

/// A place in a file, as far as it is known; counted from 1.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Place {
    /// Line.
    pub line: Option<usize>,
    /// Column of the text, in characters.
    pub column: Option<usize>,
    /// Name of the table column or key.
    pub field: Option<String>,
}

impl Place {
    /// A line of a file.
    #[must_use]
    pub fn line(line: usize) -> Self {
        Self { line: Some(line), ..Self::default() }
    }

    /// A named column, or key, of a line.
    #[must_use]
    pub fn field(line: usize, field: &str) -> Self {
        Self { line: Some(line), field: Some(field.to_owned()), ..Self::default() }
    }

    /// The line and column of a byte offset in a text.
    #[must_use]
    pub fn offset(text: &str, offset: usize) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        Self { line: Some(line), column: Some(column), field: None }
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(column) = self.column {
            write!(f, ":{column}")?;
        }
        if let Some(field) = &self.field {
            write!(f, ", column {field}")?;
        }
        Ok(())
    }
}

impl Error {
    /// Of a file.
    pub fn file(
        path: &Path,
        place: Place,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self::File {
            path: path.to_owned(),
            place: Box::new(place),
            message: shortened(message.into()),
            help: shortened(help.into()),
            excerpt: None,
        }
    }

    /// The same error of a file with the part of its text that is meant.
    #[must_use]
    pub fn showing(mut self, text: &str, span: Range<usize>) -> Self {
        if let Self::File { excerpt, .. } = &mut self {
            let end = span.end.min(text.len());
            let span = span.start.min(end)..end;
            *excerpt = Some(Box::new(Excerpt { text: text.to_owned(), span }));
        }
        self
    }

    /// Of the data as a whole.
    pub fn data(kind: Kind, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Data { kind, message: shortened(message.into()), help: shortened(help.into()) }
    }

    /// Of the command line.
    pub fn usage(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Usage { message: shortened(message.into()), help: shortened(help.into()) }
    }

    /// Of the system.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    /// Rows that contradict the others, and more of them than errors of single
    /// rows can be.
    #[must_use]
    pub fn contradiction(rows: usize, of: usize) -> Self {
        Self::data(
            Kind::Contradiction,
            format!("{rows} of {of} rows contradict the rest"),
            "so many are no outliers: check joint senses, units and the nominal geometry; \
             `truearm diagnose` shows which rows they are",
        )
    }

    /// A result that is no number, by its name: nothing of it is written.
    #[must_use]
    pub fn not_finite(what: &str, value: f64) -> Self {
        Self::data(
            Kind::NotFinite,
            format!("{what} is {value}: nothing is written"),
            "a value of the robot, the model or the rows is too large to compute with, or too few \
             directions are known: `truearm check` looks for such",
        )
    }

    /// Which kind of error it is.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Io { .. } => Kind::Io,
            Self::File { .. } => Kind::File,
            Self::Usage { .. } => Kind::Usage,
            Self::Data { kind, .. } => *kind,
        }
    }

    /// What to do about it; empty if the message says it all.
    #[must_use]
    pub fn help(&self) -> &str {
        match self {
            Self::Io { .. } => "",
            Self::File { help, .. } | Self::Usage { help, .. } | Self::Data { help, .. } => help,
        }
    }
}

/// Names that a message lists before it only counts.
const MOST_NAMES: usize = 40;

/// Names for a message, the first of them if there are many.
#[must_use]
pub fn listed<T: std::fmt::Display>(names: &[T]) -> String {
    let mut shown: Vec<String> = names.iter().take(MOST_NAMES).map(T::to_string).collect();
    if names.len() > MOST_NAMES {
        shown.push(format!("and {} others", names.len() - MOST_NAMES));
    }
    shown.join(", ")
}

/// More digits no number of a message needs.
const MOST_DIGITS: usize = 24;
/// Longer words, such as a whole line without a blank, are not read by anybody.
const LONGEST_WORD: usize = 400;
/// And no longer message, in characters.
const LONGEST_MESSAGE: usize = 4000;

/// A message whose numbers and words are short enough to be read: of longer ones
/// the beginning, and how long they are.
fn shortened(text: String) -> String {
    let long = |word: &str| word.len() > MOST_DIGITS;
    if text.len() <= LONGEST_MESSAGE && !text.split(char::is_whitespace).any(long) {
        return text;
    }
    let mut out = String::with_capacity(text.len().min(1 << 12));
    for part in text.split_inclusive(char::is_whitespace) {
        let word = part.trim_end_matches(char::is_whitespace);
        let blank = &part[word.len()..];
        out += &match word.chars().count() {
            count if count > LONGEST_WORD => {
                let head: String = word.chars().take(60).collect();
                format!("{head}... ({count} characters)")
            }
            _ => few_digits(word),
        };
        out += blank;
    }
    match out.char_indices().nth(LONGEST_MESSAGE) {
        Some((end, _)) => format!("{}... ({} characters)", &out[..end], out.chars().count()),
        None => out,
    }
}

/// A word without numbers of hundreds of digits.
fn few_digits(word: &str) -> String {
    let mut out = String::with_capacity(word.len());
    let mut rest = word;
    while let Some(begin) = rest.find(|c: char| c.is_ascii_digit()) {
        let digits = &rest[begin..];
        let end = digits.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(digits.len());
        out += &rest[..begin];
        if end > MOST_DIGITS {
            out += &format!("{}... ({end} digits)", &digits[..12]);
        } else {
            out += &digits[..end];
        }
        rest = &digits[end..];
    }
    out + rest
}

/// Results of the library.
pub type Result<T> = std::result::Result<T, Error>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_short() {
        let digits = format!("\"1{}\" is not a number", "0".repeat(299));
        assert_eq!(shortened(digits), "\"100000000000... (300 digits)\" is not a number");
        let word = format!("{} is\nno number", "x".repeat(1000));
        let said = shortened(word);
        assert!(said.ends_with("... (1000 characters) is\nno number"), "{said}");
        let said = shortened("x ".repeat(10_000));
        assert!(said.len() < 4100 && said.ends_with("... (20000 characters)"), "{said}");
        for plain in [
            "",
            "a\tb  c\n",
            "found 1.25, -3.1415926535897931 and 1e-300",
            "m.csv:2, column q1_deg",
        ] {
            assert_eq!(shortened(plain.to_owned()), plain);
        }
    }
}
