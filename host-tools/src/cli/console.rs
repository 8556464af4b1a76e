//! What a verb says when it is done.
//!
//! Files are written first; then everything for standard output goes there at
//! once. Whoever reads it may stop reading: that is no error. A full disk is.

use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use truearm_host::{Error, Result};

use super::exit_status::{self, End};
use super::shown::Shown;

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

/// What a verb has to say.
pub struct Said {
    /// For standard output.
    pub text: String,
    /// The text is what was asked for, not what there is to say of it.
    pub asked: bool,
    /// How it ended.
    pub end: End,
}

impl From<String> for Said {
    fn from(text: String) -> Self {
        Self { text, asked: false, end: End::Good }
    }
}

impl Said {
    /// What was asked for, of a verb that writes it nowhere else.
    pub fn asked(text: String) -> Self {
        Self { asked: true, ..text.into() }
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
        if quiet() && !said.asked && !said.text.starts_with('{') {
            return Ok(said.end);
        }
        let mut out = io::stdout().lock();
        printed(out.write_all(said.text.as_bytes()).and_then(|()| out.flush()))?;
        Ok(said.end)
    });
    match end {
        Ok(End::Failed(error)) | Err(error) => failed(error),
        Ok(End::Good) => ExitCode::from(exit_status::GOOD),
        Ok(End::Wrong) => ExitCode::from(exit_status::WRONG),
        Ok(End::Undecided) => ExitCode::from(exit_status::UNDECIDED),
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
    let status = exit_status::of(&error);
    let report = miette::Report::new(Shown::new(error));
    let _ = writeln!(io::stderr(), "Error: {report:?}");
    ExitCode::from(status)
}

fn printed(result: io::Result<()>) -> Result<()> {
    match result {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io(Path::new("standard output"), e))
        }
        _ => Ok(()),
    }
}
