//! Where in a file something is wrong.

use std::ops::Range;

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
