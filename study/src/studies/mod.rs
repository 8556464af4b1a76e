//! The long form of each study: options, tables, and what must be reached.

mod blind;
mod check;
mod coverage;
mod dirty;
mod fleet;
mod instruments;
mod lambda;
mod lines;
mod outside;
mod planning;
mod power;
mod reproduce;
mod rows;
mod springs;
mod ties;
mod transfer;
mod warming;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use truearm_host::diagnose::{DiagnoseOptions, diagnose};

use crate::blind::score::{Score, score};
use crate::blind::sets::{BlindSet, Wanted};
use crate::dirty::set::{DirtySet, Sort};

/// What a study ends with: a sentence if less was reached than is required.
pub type Result<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;

#[derive(Subcommand)]
pub enum Study {
    /// Hidden effects: are they named, rightly and only where they are?
    Blind(blind::Options),
    /// Several effects, noise misstated, poses as people choose them: can probabilities be trusted?
    Dirty(dirty::Options),
    /// Gross mistakes between robot and measurements: are they named?
    Check(check::Options),
    /// How large must an effect be to be named?
    Power(power::Options),
    /// Stated 95 % intervals: how many hold the truth?
    Coverage(coverage::Options),
    /// What each kind of measurement is worth, and whether it reaches its bound
    Instruments(instruments::Options),
    /// Planned poses against random ones
    Planning(planning::Options),
    /// Tolerances learned from arms of a type: what are they worth for the next arm?
    Fleet(fleet::Options),
    /// Lines of unknown order at any number of rows: are there others than the true ones?
    Lines(lines::Options),
    /// Effects outside the repertoire: is it said what errs, and with what?
    Outside(outside::Options),
    /// One spring under loads that nobody states: is it named, and nothing beside it?
    Springs(springs::Options),
    /// Time and memory of an identification against the number of rows
    Rows(rows::Options),
    /// Rules for lambda: how much worse than the best one?
    Lambda(lambda::Options),
    /// A model of one half of the poses on the other half
    Transfer(transfer::Options),
    /// Two effects look alike: is it said, and do the proposed poses tell?
    Ties(ties::Options),
    /// Links that follow the temperature late: is it said, and how late?
    Warming(warming::Options),
    /// The paper's experiment on simulated cells: its tables and figures, and a discussion
    Reproduce(reproduce::Options),
}

pub fn run(study: &Study) -> Result {
    match study {
        Study::Blind(options) => blind::run(options),
        Study::Dirty(options) => dirty::run(options),
        Study::Check(options) => check::run(options),
        Study::Power(options) => power::run(options),
        Study::Coverage(options) => coverage::run(options),
        Study::Instruments(options) => instruments::run(options),
        Study::Planning(options) => planning::run(options),
        Study::Fleet(options) => fleet::run(options),
        Study::Lines(options) => lines::run(options),
        Study::Rows(options) => rows::run(options),
        Study::Outside(options) => outside::run(options),
        Study::Springs(options) => springs::run(options),
        Study::Lambda(options) => lambda::run(options),
        Study::Transfer(options) => transfer::run(options),
        Study::Ties(options) => ties::run(options),
        Study::Warming(options) => warming::run(options),
        Study::Reproduce(options) => reproduce::run(options),
    }
}

/// One set alone.
#[derive(Args)]
struct One {
    /// Only this one, with its files in a folder
    #[arg(long)]
    only: Option<u64>,
    /// Folder for that set's files
    #[arg(long, requires = "only")]
    out: Option<PathBuf>,
}

impl One {
    /// The seed that is asked for, its files written if they are.
    fn drawn(&self, sort: Sort) -> Result<Option<u64>> {
        if let (Some(seed), Some(folder)) = (self.only, &self.out) {
            DirtySet::draw(seed, sort).write(folder)?;
        }
        Ok(self.only)
    }
}

/// The answer of every seed, on all cores, with a bar.
fn of_each<A: Send>(
    seeds: std::ops::Range<u64>,
    answer: impl Fn(u64) -> A + Sync,
) -> Result<Vec<A>> {
    let style = "{bar:40} {pos}/{len}  {elapsed_precise}, {eta} left";
    let bar = ProgressBar::new(seeds.end.saturating_sub(seeds.start));
    bar.set_style(ProgressStyle::with_template(style)?);
    let one = |seed: u64| {
        let out = answer(seed);
        bar.inc(1);
        out
    };
    let all = seeds.into_par_iter().map(one).collect();
    bar.finish_and_clear();
    Ok(all)
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
            Ok(found) => Ok((set, found.outcome)),
            Err(error) => Err(format!("seed {seed}: {error}")),
        }
    };
    let answers: Vec<_> = plans.par_iter().map(answer).collect();
    bar.finish_and_clear();
    let answers = answers.into_iter().collect::<std::result::Result<Vec<_>, String>>()?;
    Ok(answers.par_iter().map(|(set, report)| score(set, report)).collect())
}
