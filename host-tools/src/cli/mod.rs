//! The command line: one file a subcommand, each a thin layer over the library.

mod diagnose;
mod evaluate;
mod identify;
mod inspect;
mod pack;
mod progress;
mod table;

use clap::{Parser, Subcommand};
use miette::miette;

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
    Pack(pack::Pack),
    Inspect(inspect::Inspect),
}

impl Cli {
    /// Runs the verb.
    pub fn run(self) -> miette::Result<()> {
        let done = match self.verb {
            Verb::Identify(verb) => verb.run(),
            Verb::Diagnose(verb) => verb.run(),
            Verb::Evaluate(verb) => verb.run(),
            Verb::Pack(verb) => verb.run(),
            Verb::Inspect(verb) => verb.run(),
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
