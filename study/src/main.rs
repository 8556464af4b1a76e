//! `truearm-study NAME`: figures too long for a test run.

use std::process::ExitCode;

use clap::Parser;
use truearm_study::studies::{Study, run};

#[derive(Parser)]
#[command(name = "cargo xtask study", about = "Figures too long for a test run")]
struct Arguments {
    #[command(subcommand)]
    study: Study,
}

fn main() -> ExitCode {
    match run(&Arguments::parse().study) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("\nFAILED {error}");
            ExitCode::FAILURE
        }
    }
}
