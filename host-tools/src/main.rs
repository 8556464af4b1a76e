//! `truearm`: identify a robot arm from tracker data, score the result, pack it
//! for the controller.

mod cli;

use clap::Parser;

fn main() -> miette::Result<()> {
    cli::Cli::parse().run()
}
