//! `cargo xtask study NAME`: figures too long for a test run. One file a study.

mod blind;
mod coverage;
mod cuts;
mod flips;
pub mod fuzz;
mod lambda;
mod planning;
mod power;
pub mod restarts;
mod ties;

/// The simulator of the host's tests.
#[path = "../../../host-tools/tests/simulate/mod.rs"]
pub mod simulate;

/// The memory of the store's tests, and what cuts its power.
#[path = "../../../tests/store/bench/mod.rs"]
mod bench;

use clap::Subcommand;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use truearm_host::diagnose::{DiagnoseOptions, diagnose};

use crate::run::{Result, call, cargo, root};
use simulate::secret::{Score, score};
use simulate::sets::{BlindSet, Wanted};

#[derive(Subcommand)]
pub enum Study {
    /// Hidden effects: are they named, rightly and only where they are?
    Blind(blind::Options),
    /// How large must an effect be to be named?
    Power(power::Options),
    /// Stated 95 % intervals: how many hold the truth?
    Coverage(coverage::Options),
    /// Planned poses against random ones
    Planning(planning::Options),
    /// Every single and every pair of flipped bits of a full blob: is it refused?
    Flips,
    /// Rules for lambda: how much worse than the best one?
    Lambda(lambda::Options),
    /// Two effects look alike: is it said, and do the proposed poses tell?
    Ties(ties::Options),
    /// The power fails at every operation of a store, and again in what follows
    Cuts(cuts::Options),
    /// The emulated board's power fails at random moments while it stores
    Restarts(restarts::Options),
    /// Bytes that are no blob, and histories of power cuts, guided by coverage
    Fuzz(fuzz::Options),
}

pub fn run(study: &Study) -> Result {
    if cfg!(debug_assertions) {
        // Hours instead of minutes: the same again, optimised.
        let mut again = cargo(&root(), "run --quiet --release --package xtask --");
        return call(again.args(std::env::args_os().skip(1)));
    }
    match study {
        Study::Blind(options) => blind::run(options),
        Study::Power(options) => power::run(options),
        Study::Coverage(options) => coverage::run(options),
        Study::Planning(options) => planning::run(options),
        Study::Flips => flips::run(),
        Study::Lambda(options) => lambda::run(options),
        Study::Ties(options) => ties::run(options),
        Study::Cuts(options) => cuts::run(options),
        Study::Restarts(options) => restarts::study(options),
        Study::Fuzz(options) => fuzz::study(options),
    }
}

/// Draws sets, has them diagnosed, and opens what was hidden when all verdicts
/// are in. A set that cannot be diagnosed fails the study.
fn judged(plans: &[(u64, Vec<Wanted>)]) -> Result<Vec<Score>> {
    let style = "{bar:40} {pos}/{len}  {elapsed_precise}, {eta} left";
    let bar = ProgressBar::new(plans.len() as u64).with_style(ProgressStyle::with_template(style)?);
    let answer = |(seed, wanted): &(u64, Vec<Wanted>)| {
        let set = BlindSet::draw(*seed, wanted);
        let (robot, data, holdout) = set.read();
        let options = DiagnoseOptions::default();
        let found = diagnose(&robot, &data, Some(&holdout), &options, &|_| ());
        bar.inc(1);
        match found {
            Ok(found) => Ok((set, found.report)),
            Err(error) => Err(format!("seed {seed}: {error}")),
        }
    };
    let answers: Vec<_> = plans.par_iter().map(answer).collect();
    bar.finish_and_clear();
    let answers = answers.into_iter().collect::<std::result::Result<Vec<_>, String>>()?;
    Ok(answers.par_iter().map(|(set, report)| score(set, report)).collect())
}
