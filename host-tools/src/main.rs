//! `truearm`: identify a robot arm from tracker data, score the result, pack it
//! for the controller.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
