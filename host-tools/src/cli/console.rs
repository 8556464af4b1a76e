//! What a verb says when it is done, and the exit status.
//!
//! Files are written first; then everything for standard output goes there at
//! once. Whoever reads it may stop reading: that is no error. A full disk is.

use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use truearm_host::error::Excerpt;
use truearm_host::{Error, Kind, Result};

/// The table of exit statuses, the same for all verbs.
pub const TABLE: &str = "\
Exit status:
  0  done and good
  1  error
  2  wrong usage
  3  found wrong: verify, an error beyond the tolerance; check, a mistake and what undoes it;
     ik and compensate, rows that the arm does not reach or the model does not cover
  4  cannot be decided: verify, the tolerance is within the uncertainty; check, nothing
     explains the disagreement, or there are fewer than 6 poses
     or 8 points";

/// Whether nothing is said but errors: set once, before the verb runs.
static QUIET: AtomicBool = AtomicBool::new(false);

/// As the command line asks.
pub fn set_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

fn quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Version and time, for who asked.
pub fn took(time: Duration) {
    let version = env!("CARGO_PKG_VERSION");
    let _ = writeln!(io::stderr(), "truearm {version}: {:.2} s", time.as_secs_f64());
}

/// How a verb ended.
pub enum End {
    /// Done and good.
    Good,
    /// Done, but not what was asked for.
    Failed(Error),
    /// What was judged is wrong.
    Wrong,
    /// What was judged is neither proven good nor wrong.
    Undecided,
}

/// What a verb has to say.
pub struct Said {
    /// For standard output.
    pub text: String,
    /// How it ended.
    pub end: End,
}

impl From<String> for Said {
    fn from(text: String) -> Self {
        Self { text, end: End::Good }
    }
}

/// Remarks go to standard error, so that `--json` stays clean. Nobody need
/// read them.
pub fn warn(warnings: &[String]) {
    if quiet() {
        return;
    }
    for warning in warnings {
        let _ = writeln!(io::stderr(), "warning: {warning}");
    }
}

/// Prints what there is to say; the exit status.
pub fn finish(done: Result<Said>) -> ExitCode {
    let end = done.and_then(|said| {
        // JSON was asked for, and is no talk.
        if quiet() && !said.text.starts_with('{') {
            return Ok(said.end);
        }
        let mut out = io::stdout().lock();
        printed(out.write_all(said.text.as_bytes()).and_then(|()| out.flush()))?;
        Ok(said.end)
    });
    match end {
        Ok(End::Good) => ExitCode::SUCCESS,
        Ok(End::Wrong) => ExitCode::from(3),
        Ok(End::Undecided) => ExitCode::from(4),
        Ok(End::Failed(error)) | Err(error) => failed(error),
    }
}

/// The command line could not be read, or asks for help.
pub fn usage(error: &clap::Error) -> ExitCode {
    let print = error.print().and_then(|()| io::stdout().flush());
    match printed(print) {
        Err(error) => failed(error),
        Ok(()) => ExitCode::from(error.exit_code() as u8),
    }
}

fn failed(error: Error) -> ExitCode {
    let status = if error.kind() == Kind::Usage { 2 } else { 1 };
    let report = miette::Report::new(Shown::new(error));
    let _ = writeln!(io::stderr(), "Error: {report:?}");
    ExitCode::from(status)
}

/// An error with what to do and, where it is in a file, the place in its text.
#[derive(Debug)]
struct Shown {
    error: Error,
    source: Option<NamedSource<String>>,
}

impl Shown {
    fn new(error: Error) -> Self {
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

fn printed(result: io::Result<()>) -> Result<()> {
    match result {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io(Path::new("standard output"), e))
        }
        _ => Ok(()),
    }
}
