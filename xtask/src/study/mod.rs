//! `cargo xtask study NAME`: figures too long for a test run. One file a study.

mod cuts;
mod flips;
pub mod fuzz;
mod parts;
pub mod restarts;
mod ticks;

/// The memory of the store's tests, and what cuts its power.
#[path = "../../../tests/store/rig/mod.rs"]
mod rig;

use std::env;
use std::ffi::OsString;

use clap::Subcommand;

use crate::run::{Result, call, cargo, root};

/// Studies of the package `truearm-study`, for the help.
pub const OF_ARMS: &str = "Of arms whose truth is known (cargo xtask study NAME --help): \
                           blind, dirty, power, ties, check, coverage, planning, fleet, instruments, \
                           lambda, lines, outside, springs, transfer, reproduce, rows, \
                           warming";

#[derive(Subcommand)]
pub enum Study {
    /// Every single and every pair of flipped bits of a full blob: is it refused?
    Flips,
    /// The power fails at every operation of a store, and again in what follows
    Cuts(cuts::Options),
    /// The emulated board's power fails at random moments while it stores
    Restarts(restarts::Options),
    /// What compensation promises, along a million ticks of random paths
    Ticks,
    /// Bytes that are no blob, and histories of power cuts, guided by coverage
    Fuzz(fuzz::Options),
    /// Is an arm identified by parts, by Dask and by Spark that of one run?
    Parts,
    /// Of arms whose truth is known: the package `truearm-study`
    #[command(external_subcommand)]
    Arms(Vec<OsString>),
}

pub fn run(study: &Study) -> Result {
    if let Study::Arms(words) = study {
        // Where the user is: an `--out` may be relative.
        let mut command = cargo(&env::current_dir()?, "run --quiet --release --manifest-path");
        command.arg(root().join("study/Cargo.toml")).arg("--").args(words);
        return call(&mut command);
    }
    // What computes for itself would take hours instead of minutes: the same again, optimised.
    if cfg!(debug_assertions) && !matches!(study, Study::Fuzz(_)) {
        let mut again = cargo(&root(), "run --quiet --release --package xtask --");
        return call(again.args(env::args_os().skip(1)));
    }
    match study {
        Study::Flips => flips::run(),
        Study::Cuts(options) => cuts::run(options),
        Study::Ticks => ticks::run(),
        Study::Parts => parts::run(),
        Study::Restarts(options) => restarts::study(options),
        Study::Fuzz(options) => fuzz::study(options),
        Study::Arms(_) => Ok(()),
    }
}
