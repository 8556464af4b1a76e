//! Gross mistakes: are they named, and are sound files left in peace?

use std::collections::BTreeMap;

use clap::Args;

use super::Result;
use crate::check::{Trial, alarms, name, tally, told, trials};
use crate::mistakes::Outcome;

#[derive(Args)]
pub struct Options {
    /// Sessions with one mistake
    #[arg(long, default_value_t = 1000)]
    singles: u64,
    /// Sessions with two
    #[arg(long, default_value_t = 300)]
    doubles: u64,
    /// Sessions without
    #[arg(long, default_value_t = 300)]
    sound: u64,
    /// Joints within 50 degrees, gross rows, the tool misstated; nothing is required then
    #[arg(long)]
    hard: bool,
    /// Another seed, other sessions
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

const OUTCOMES: [(Outcome, &str); 6] = [
    (Outcome::Named, "named"),
    (Outcome::Equivalent, "equivalent"),
    (Outcome::Absorbed, "absorbed"),
    (Outcome::Missed, "missed"),
    (Outcome::Wrong, "wrong"),
    (Outcome::NotUnderstood, "not understood"),
];

pub fn run(options: &Options) -> Result {
    let mut missed = Vec::new();
    for (mistakes, count, least) in [(1, options.singles, 0.98), (2, options.doubles, 0.9)] {
        let trials = trials(
            (options.seed << 32) + 1_000_000 * mistakes as u64,
            count,
            mistakes,
            options.hard,
        );
        println!("\n{count} sessions, mistakes in each: {mistakes}\n");
        table("mistake", &tally(&trials, |t| t.mistakes.iter().map(name).collect()));
        table("arm", &tally(&trials, |t| vec![t.arm.clone()]));
        let good = trials.iter().filter(|t| told(t.outcome)).count() as f64 / count.max(1) as f64;
        let slowest = trials.iter().map(|t| t.seconds).fold(0.0, f64::max);
        println!("told: {:.1} %; slowest check {slowest:.2} s on a shared thread", good * 100.0);
        trials.iter().filter(|t| !told(t.outcome)).for_each(failed);
        if count > 0 && good < least {
            missed.push(format!("{mistakes} at once: {:.1} %", good * 100.0));
        }
    }
    let alarms = alarms(options.seed << 32, options.sound, options.hard);
    println!("\nalarms in {} sound sessions: {}", options.sound, alarms.len());
    for (seed, said) in &alarms {
        println!("  seed {seed}: {said}");
        missed.push(format!("an alarm at seed {seed}"));
    }
    if missed.is_empty() || options.hard { Ok(()) } else { Err(missed.join("; ").into()) }
}

fn failed(trial: &Trial) {
    println!("  {}: {:?} -> {:?}: {}", trial.arm, trial.mistakes, trial.outcome, trial.said);
}

fn table(what: &str, tally: &BTreeMap<String, BTreeMap<Outcome, usize>>) {
    let names: Vec<&str> = OUTCOMES.iter().map(|(_, name)| *name).collect();
    println!("| {what} | {} |", names.join(" | "));
    println!("|---|{}", "---|".repeat(names.len()));
    for (name, counts) in tally {
        let cells = OUTCOMES.map(|(outcome, _)| counts.get(&outcome).copied().unwrap_or(0));
        println!("| {name} | {} |", cells.map(|c| c.to_string()).join(" | "));
    }
    println!();
}
