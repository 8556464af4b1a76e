//! What can go wrong, said so that the user knows where and what to do.

use std::path::{Path, PathBuf};

/// An error of the library. `Display` is one line; [`Error::help`] says what to do.
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
    },
    /// A command line whose values make no sense.
    #[error("{message}")]
    Usage {
        /// What is wrong.
        message: String,
        /// What to do about it.
        help: String,
    },
    /// Rows that contradict the others, and more of them than errors of single
    /// rows can be.
    #[error("{rows} of {of} rows contradict the rest")]
    Contradiction {
        /// How many.
        rows: usize,
        /// Of how many.
        of: usize,
    },
    /// Data that cannot answer what was asked of them.
    #[error("{message}")]
    Data {
        /// What is wrong.
        message: String,
        /// What to do about it.
        help: String,
    },
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
            message: message.into(),
            help: help.into(),
        }
    }

    /// Of the data as a whole.
    pub fn data(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Data { message: message.into(), help: help.into() }
    }

    /// Of the command line.
    pub fn usage(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Usage { message: message.into(), help: help.into() }
    }

    /// Of the system.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    /// What to do about it; empty if the message says it all.
    #[must_use]
    pub fn help(&self) -> &str {
        match self {
            Self::Io { .. } => "",
            Self::Contradiction { .. } => {
                "so many are no outliers: check joint senses, units and the nominal geometry; \
                 `truearm diagnose` shows which rows they are"
            }
            Self::File { help, .. } | Self::Usage { help, .. } | Self::Data { help, .. } => help,
        }
    }
}

/// Results of the library.
pub type Result<T> = std::result::Result<T, Error>;
