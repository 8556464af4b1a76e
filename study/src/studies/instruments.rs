//! What each kind of measurement is worth: the same arms, the same effort, the
//! tool's error over the workspace, and how many it takes for 0.1 mm.

use std::path::PathBuf;

use clap::Args;
use rayon::prelude::*;
use truearm_host::diagnose::Verdict;
use truearm_host::model::Robot;
use truearm_host::plot::{Panel, grid};
use truearm_simulate::robots;

use super::Result;
use crate::apart::TOLD;
use crate::instruments::cases::{CASES, OTHERS, Wanted, needed, open};
use crate::instruments::named::{Answered, FILES, TURNING, Truth, answered};
use crate::instruments::scanner::{Setup, means};
use crate::instruments::{held, mixed, worth};
use crate::judged::efficiency;
use crate::simulated::robot;

#[derive(Args)]
pub struct Options {
    /// Arms of each case
    #[arg(long, default_value_t = 400)]
    arms: u64,
    /// Only cases whose words contain this
    #[arg(long, default_value = "")]
    only: String,
    /// Leave out how many are needed for 0.1 mm, which takes longest
    #[arg(long)]
    without_needed: bool,
    /// So many simulations of each case instead: do 95 % intervals hold the truth?
    #[arg(long, value_name = "SIMULATIONS")]
    coverage: Option<u64>,
    /// Few points and many touches instead, together and alone
    #[arg(long)]
    mixed: bool,
    /// So many blind sets with an effect instead: is it named?
    #[arg(long, value_name = "SETS")]
    named: Option<u64>,
    /// Those sets of pairs, poses, inclinations, ranges and images
    #[arg(long, requires = "named")]
    turning: bool,
    /// The first of those sets
    #[arg(long, default_value_t = 0, requires = "named")]
    seed: u64,
    /// By up to this factor, either way, the sigma of each kind in them is stated wrongly
    #[arg(long, value_name = "FACTOR", default_value_t = 2.0, requires = "named")]
    misstated: f64,
    /// How the error falls with the number instead, drawn into this file (.svg)
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
    /// The published range finder before three planes instead (SCALAR)
    #[arg(long)]
    scanner: bool,
}

/// Whose tool error is asked for.
const ARMS: [(&str, &str); 2] = [("6R", robots::UR10_LIKE), ("7R", robots::ALL[4])];

/// Shares of 95 % intervals that are as they should be.
const HOLD: std::ops::RangeInclusive<f64> = 0.935..=0.965;

pub fn run(options: &Options) -> Result {
    if options.scanner {
        return scanner(options.arms);
    }
    if let Some(sets) = options.named {
        let files = if options.turning { &TURNING[..] } else { &FILES[..] };
        return blind(options.seed, sets, options.misstated, files);
    }
    let arms = || ARMS.map(|(name, text)| (name, robot(text))).into_iter();
    if let Some(file) = &options.figure {
        let panels: Vec<Panel> = arms().map(|(n, r)| worth::panel(n, &r, options.arms)).collect();
        return Ok(std::fs::write(file, grid(&panels, 1))?);
    }
    let mut missed = Vec::new();
    for (name, robot) in arms() {
        let wrong = match options {
            Options { mixed: true, .. } => mixed(name, &robot, options.arms)?,
            Options { coverage: Some(count), .. } => coverage(name, &robot, options, *count),
            _ => table(name, &robot, options),
        };
        missed.extend(wrong);
    }
    match missed.is_empty() {
        true => Ok(()),
        false => Err(missed.join("; ").into()),
    }
}

fn cases(only: &str) -> impl Iterator<Item = (&'static str, &'static Wanted)> {
    CASES.into_iter().chain(OTHERS).filter(move |(what, _)| what.contains(only))
}

/// Errors against their bound, a row a case; what is above it.
fn table(name: &str, robot: &Robot, options: &Options) -> Vec<String> {
    let mut missed = Vec::new();
    println!("\n| {name}: measured | tool error, mm | of the bound | needed for 0.1 mm | open |");
    println!("|---|---|---|---|---|");
    for (what, wanted) in cases(&options.only) {
        let [ratio, two_errors, bound] = efficiency(robot, wanted, options.arms);
        let needed = match options.without_needed || wanted.len() > 1 {
            true => "-".to_owned(),
            false => needed(robot, wanted)
                .map_or("more than 16 times as many".to_owned(), |n| n.to_string()),
        };
        let (open, words) = open(robot, wanted);
        let of = 5 * robot.joints.len();
        let error = ratio * bound * 1e3;
        println!(
            "| {what} | {error:.4} | {ratio:.3} +- {two_errors:.3} | {needed} | {open} of {of}; {words} |"
        );
        if ratio > 1.03 + two_errors {
            missed.push(format!("{name}, {what}: {ratio:.3} of the bound"));
        }
    }
    missed
}

/// Intervals that hold the truth, a row a case; what is not as it should be.
fn coverage(name: &str, robot: &Robot, options: &Options, simulations: u64) -> Vec<String> {
    let mut missed = Vec::new();
    println!("\n| {name}: measured | parameters | combinations of them |");
    println!("|---|---|---|");
    for (what, wanted) in cases(&options.only) {
        let shares = held::shares(robot, wanted, simulations);
        let [parameters, combinations] = shares.map(|share| share * 100.0);
        println!("| {what} | {parameters:.2} % | {combinations:.2} % |");
        if shares.iter().any(|share| !HOLD.contains(share)) {
            missed.push(format!("{name}, {what}: {parameters:.2} %, {combinations:.2} %"));
        }
    }
    missed
}

/// Points and touches; what is worse than it should be.
fn mixed(name: &str, robot: &Robot, arms: u64) -> Result<Vec<String>> {
    println!("\n| {name}: measured | tool error, mm | sigmas taken as stated |");
    println!("|---|---|---|");
    let errors = mixed::compared(robot, arms)?;
    for ((what, ..), [estimated, stated]) in mixed::FITS.iter().zip(&errors) {
        println!("| {what} | {:.4} | {:.4} |", estimated * 1e3, stated * 1e3);
    }
    let wrong = mixed::hurt(&errors).map(|what| format!("{name}: {what}"));
    Ok(wrong.into_iter().collect())
}

/// Least share of what can be told that is to be named.
const NAMED: f64 = 0.9;

/// Effects behind what is no point, a row a file; whether enough are named.
fn blind(
    first: u64,
    sets: u64,
    misstated: f64,
    files: &[(&'static str, &'static Wanted)],
) -> Result {
    let seeds = (first..first + sets).into_par_iter();
    let all = seeds.map(|seed| (seed, answered(seed, misstated, files)));
    let mut answers = Vec::new();
    for (seed, answer) in all.collect::<Vec<_>>() {
        match answer {
            Ok(answer) => answers.push((seed, answer)),
            Err(error) => println!("set {seed}: {error}"),
        }
    }
    println!(
        "| measured | sets | effects told | named | mentioned | not told | named | other names | \
         nothing hidden | clean |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    let mut share = [0, 0];
    for (file, _) in files {
        let own: Vec<&Answered> =
            answers.iter().map(|(_, a)| a).filter(|a| a.file == *file).collect();
        let truths = own.iter().flat_map(|a| &a.hidden);
        let (told, dark): (Vec<&Truth>, Vec<&Truth>) = truths.partition(|t| t.sure >= TOLD);
        let named = |all: &[&Truth]| all.iter().filter(|t| t.named).count();
        let empty: Vec<_> = own.iter().filter(|a| a.hidden.is_empty()).collect();
        share = [share[0] + named(&told), share[1] + told.len()];
        println!(
            "| {file} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            own.len(),
            told.len(),
            named(&told),
            told.iter().filter(|t| !t.named && t.mentioned).count(),
            dark.len(),
            named(&dark),
            own.iter().map(|a| a.wrong.len()).sum::<usize>(),
            empty.len(),
            empty.iter().filter(|a| a.verdict == Verdict::Clean).count(),
        );
    }
    for (seed, answer) in &answers {
        for t in answer.hidden.iter().filter(|t| t.sure >= TOLD && !t.named) {
            println!("  set {seed}, {}: {:?} by {:.1} is not named", answer.file, t.place, t.sure);
        }
        if !answer.wrong.is_empty() {
            println!("  set {seed}, {}: {:?} is named", answer.file, answer.wrong);
        }
    }
    if (share[0] as f64) < NAMED * share[1] as f64 {
        return Err(format!("{} of {} that can be told are named", share[0], share[1]).into());
    }
    Ok(())
}

/// The published sensor; whether what was published is reached.
fn scanner(arms: u64) -> Result {
    println!("| sigma, mm | poses | before | after |\n|---|---|---|---|");
    println!("| not known | not known | 14.6 mm, 4.05 deg | 0.09 mm, 0.02 deg (published) |");
    let mut last = [0.0; 2];
    for (sigma, poses) in [(1e-4, 10), (1e-4, 20), (1e-4, 40), (5e-5, 20), (5e-5, 40)] {
        let [before, after] = means(Setup { sigma, poses }, arms)?;
        let say = |[place, turn]: [f64; 2]| {
            format!("{:.3} mm, {:.4} deg", place * 1e3, turn.to_degrees())
        };
        println!("| {} | 3 x {poses} | {} | {} |", sigma * 1e3, say(before), say(after));
        last = [after[0] * 1e3, after[1].to_degrees()];
    }
    match last[0] < 0.09 && last[1] < 0.02 {
        true => Ok(()),
        false => Err("the last row does not reach what was published".into()),
    }
}
