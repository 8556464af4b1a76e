//! The command line: one file a subcommand, each a thin layer over the library.

mod compare;
mod diagnose;
mod diff;
mod evaluate;
mod identify;
mod inspect;
mod pack;
mod plan;
mod progress;
mod region;
mod reproduce;
mod table;
mod unpack;
mod verify;

use std::path::Path;

use clap::{Parser, Subcommand};
use miette::miette;
use truearm::blob::{AcceptanceError, Blob};
use truearm_host::explain::explain;
use truearm_host::files::{Model, write};
use truearm_host::{Error, Result};

/// Identify the true geometry of a robot arm from tracker measurements.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
pub struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Identify(identify::Identify),
    Diagnose(diagnose::Diagnose),
    Evaluate(evaluate::Evaluate),
    Compare(compare::Compare),
    Reproduce(reproduce::Reproduce),
    Pack(pack::Pack),
    Inspect(inspect::Inspect),
    Diff(diff::Diff),
    Unpack(unpack::Unpack),
    Plan(plan::Plan),
    Verify(verify::Verify),
}

impl Cli {
    /// Runs the verb.
    pub fn run(self) -> miette::Result<()> {
        let done = match self.verb {
            Verb::Identify(verb) => verb.run(),
            Verb::Diagnose(verb) => verb.run(),
            Verb::Evaluate(verb) => verb.run(),
            Verb::Compare(verb) => verb.run(),
            Verb::Reproduce(verb) => verb.run(),
            Verb::Pack(verb) => verb.run(),
            Verb::Inspect(verb) => verb.run(),
            Verb::Diff(verb) => verb.run(),
            Verb::Unpack(verb) => verb.run(),
            Verb::Plan(verb) => verb.run(),
            Verb::Verify(verb) => verb.run(),
        };
        done.map_err(|e| {
            if e.help().is_empty() { miette!("{e}") } else { miette!(help = e.help(), "{e}") }
        })
    }
}

/// Remarks go to standard error, so that `--json` stays clean.
fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}

/// Reads a file and takes it as a blob; what is wrong with it is explained.
fn read_blob(path: &Path) -> Result<Vec<u8>> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    match Blob::check(&bytes) {
        Ok(_) => Ok(bytes),
        Err(error) => Err(refused(path, &bytes, &error.into())),
    }
}

fn refused(path: &Path, bytes: &[u8], refusal: &AcceptanceError) -> Error {
    Error::data(format!("{}: {refusal}", path.display()), explain(bytes, refusal))
}

/// A report as JSON.
fn to_json(report: &impl serde::Serialize) -> String {
    serde_json::to_string_pretty(report).unwrap_or_else(|e| unreachable!("a plain struct: {e}"))
        + "\n"
}

/// Prints a report, as JSON or in words, and writes the files of a folder.
fn deliver(
    report: &impl serde::Serialize,
    words: impl FnOnce() -> String,
    as_json: bool,
    folder: Option<&Path>,
    model: &Model,
    residuals: impl FnOnce() -> String,
) -> Result<()> {
    let json = to_json(report);
    if as_json {
        print!("{json}");
    } else {
        print!("{}", words());
    }
    let Some(folder) = folder else { return Ok(()) };
    write(&folder.join("model.toml"), model.to_toml().as_bytes())?;
    write(&folder.join("report.json"), json.as_bytes())?;
    write(&folder.join("residuals.csv"), residuals().as_bytes())?;
    if !as_json {
        println!("wrote {}", folder.join("{model.toml,report.json,residuals.csv}").display());
    }
    Ok(())
}
