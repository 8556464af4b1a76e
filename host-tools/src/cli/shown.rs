//! Errors as the terminal shows them: with the place in the user's file.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use truearm_host::Error;
use truearm_host::error::Excerpt;

/// An error with what to do and, where it is in a file, the place in its text.
#[derive(Debug)]
pub struct Shown {
    error: Error,
    source: Option<NamedSource<String>>,
}

impl Shown {
    pub fn new(error: Error) -> Self {
        let source = match &error {
            Error::File { path, excerpt: Some(excerpt), .. } if shown(excerpt) => {
                Some(NamedSource::new(path.display().to_string(), excerpt.text.clone()))
            }
            _ => None,
        };
        Self { error, source }
    }
}

/// Longer lines are no help, and nothing draws them soon.
const LONGEST_LINE: usize = 2000;

/// Whether what is wrong can be shown in its place: among lines that can be read.
fn shown(excerpt: &Excerpt) -> bool {
    let Excerpt { text, span } = excerpt;
    let before = text.get(..span.start).unwrap_or("").rsplit('\n').take(2);
    let behind = text.get(span.start..).unwrap_or("");
    let lines = behind.get(..span.len()).unwrap_or("").matches('\n').count();
    before.chain(behind.split('\n').take(lines + 2)).all(|line| line.len() < LONGEST_LINE / 2)
}

impl std::fmt::Display for Shown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.error.fmt(f)
    }
}

impl std::error::Error for Shown {}

impl Diagnostic for Shown {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        let help = self.error.help();
        (!help.is_empty()).then(|| Box::new(help) as _)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|source| source as _)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (Error::File { excerpt: Some(excerpt), .. }, Some(_)) = (&self.error, &self.source)
        else {
            return None;
        };
        let span = excerpt.span.clone();
        Some(Box::new(std::iter::once(LabeledSpan::new(None, span.start, span.len()))))
    }
}
