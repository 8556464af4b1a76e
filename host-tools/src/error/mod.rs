//! What can go wrong, said so that the user knows where and what to do, and of a
//! kind, so that a program can ask which it is.

mod place;
mod words;

use std::ops::Range;
use std::path::{Path, PathBuf};

pub use place::{Excerpt, Place};
use words::shortened;
pub use words::{count, listed};

/// Kinds of errors. The words are beside it and may change; the kind does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file that could not be read or written.
    Io,
    /// Something wrong in a file the user wrote.
    File,
    /// A command line whose values make no sense.
    Usage,
    /// A file without rows, or nothing left to judge.
    NoRows,
    /// A single pose.
    TooFewPoses,
    /// Fewer equations than unknowns.
    TooFewEquations,
    /// A number that became infinite, or none: nothing is written.
    NotFinite,
    /// Points too few, or on a line, so that a frame is undetermined.
    FrameUndetermined,
    /// A tracker station that the model does not know.
    UnknownStation,
    /// A marker that the model does not know.
    UnknownMarker,
    /// A model that needs gravity torques, on data that have none.
    NoTorques,
    /// The arm follows its temperature late, and rows do not say when it was read.
    NoTimes,
    /// An iteration that did not come to rest.
    NotConverged,
    /// Rows of other kinds where only points are taken.
    NotPoints,
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
    pub fn unknown(self) -> ErrorKind {
        match self {
            Self::Station => ErrorKind::UnknownStation,
            Self::Marker => ErrorKind::UnknownMarker,
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
        kind: ErrorKind,
        /// What is wrong.
        message: String,
        /// What to do about it.
        help: String,
    },
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

    /// The same without, where lines of that part are not those of the file.
    #[must_use]
    pub(crate) fn without_excerpt(mut self) -> Self {
        if let Self::File { excerpt, .. } = &mut self {
            *excerpt = None;
        }
        self
    }

    /// The same error with more of what to do about it.
    #[must_use]
    pub fn advising(mut self, more: &str) -> Self {
        if let Self::File { help, .. } | Self::Usage { help, .. } | Self::Data { help, .. } =
            &mut self
        {
            help.push_str(more);
        }
        self
    }

    /// Of the data as a whole.
    pub fn data(kind: ErrorKind, message: impl Into<String>, help: impl Into<String>) -> Self {
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
            ErrorKind::Contradiction,
            format!("{rows} of {of} rows contradict the rest"),
            "so many are no outliers: check joint senses, units and the nominal geometry; \
             `truearm diagnose` shows which rows they are",
        )
    }

    /// A result that is no number, by its name: nothing of it is written.
    #[must_use]
    pub fn not_finite(what: &str, value: f64) -> Self {
        Self::data(
            ErrorKind::NotFinite,
            format!("{what} is {value}: nothing is written"),
            "a value of the robot, the model or the rows is too large to compute with, or too few \
             directions are known: `truearm check` looks for such",
        )
    }

    /// Which kind of error it is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Io { .. } => ErrorKind::Io,
            Self::File { .. } => ErrorKind::File,
            Self::Usage { .. } => ErrorKind::Usage,
            Self::Data { kind, .. } => *kind,
        }
    }

    /// What to do about it; empty if the message says it all.
    #[must_use]
    pub fn help(&self) -> &str {
        match self {
            Self::Io { source, .. } => match source.kind() {
                std::io::ErrorKind::NotFound => "is the name right, and the folder it stands in?",
                std::io::ErrorKind::IsADirectory => "give a file, not a folder",
                _ => "",
            },
            Self::File { help, .. } | Self::Usage { help, .. } | Self::Data { help, .. } => help,
        }
    }
}

/// Results of the library.
pub type Result<T> = std::result::Result<T, Error>;
