//! How many poses are 15 of the next arm worth with what a fleet says of its type?

use clap::Args;
use rayon::prelude::*;

use super::Result;
use crate::fleet::{Case, Errors, Spreads, Trial, WITHOUT, trial};

#[derive(Args)]
pub struct Options {
    /// Types of robot of each case, a fleet each
    #[arg(long, default_value_t = 20)]
    types: u64,
    /// Next arms of each type
    #[arg(long, default_value_t = 10)]
    arms: usize,
    /// Another seed, other arms
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// What the fleet says may make no error larger than this.
const NEVER_WORSE: f64 = 1.02;

const CASES: [Case; 18] = {
    use Spreads::{Machined, Unequal, Usual};
    [
        Case::of("unequal spreads", Unequal, 3),
        Case::of("unequal spreads", Unequal, 10),
        Case::of("unequal spreads", Unequal, 50),
        Case { stated: 0.3, ..Case::of("unequal, sigma stated at 0.3", Unequal, 10) },
        Case { stated: 3.0, ..Case::of("unequal, sigma stated at 3", Unequal, 10) },
        Case { drawing: 3, ..Case::of("unequal, drawing wrong in 3", Unequal, 10) },
        Case { crashed: true, ..Case::of("unequal, a crashed arm teaches", Unequal, 10) },
        Case { next_crashed: true, ..Case::of("unequal, next arm crashed", Unequal, 10) },
        Case::of("machined", Machined, 3),
        Case::of("machined", Machined, 10),
        Case::of("machined", Machined, 50),
        Case { next_crashed: true, ..Case::of("machined, next arm crashed", Machined, 10) },
        Case { sigma: 2e-4, ..Case::of("unequal, noise of 0.2 mm", Unequal, 10) },
        Case { sigma: 2e-4, ..Case::of("machined, noise of 0.2 mm", Machined, 10) },
        Case::of("usual tolerances", Usual, 3),
        Case::of("usual tolerances", Usual, 10),
        Case { crashed: true, ..Case::of("usual, a crashed arm teaches", Usual, 10) },
        Case { next_crashed: true, ..Case::of("usual, next arm crashed", Usual, 10) },
    ]
};

pub fn run(options: &Options) -> Result {
    println!("tool error of the next arm, um: RMS over arms (median arm)");
    let without: Vec<String> = WITHOUT.iter().map(|poses| format!("{poses} without")).collect();
    println!(
        "| arms of a type | teach | 15 taught | 15, spreads known | {} | worth | taught / 15 |",
        without.join(" | ")
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut worse = Vec::new();
    let mut named = Vec::new();
    for (k, case) in CASES.iter().enumerate() {
        let seed = |t: u64| options.seed << 32 | (k as u64) << 16 | t;
        let trials: Vec<Trial> = (0..options.types)
            .into_par_iter()
            .map(|t| trial(seed(t), case, options.arms))
            .collect();
        let ratio = row(case, &trials);
        if ratio > NEVER_WORSE {
            worse.push(format!("{}: {ratio:.3}", case.name));
        }
        named.push((case, names(&trials)));
    }
    println!(
        "\n| arms of a type | teach | fleets | a sound arm named | the crashed one | a wrong common correction | right ones |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (case, [sound, crashed, wrong, right]) in named {
        let (name, arms, fleets) = (case.name, case.arms, options.types);
        println!("| {name} | {arms} | {fleets} | {sound} | {crashed} | {wrong} | {right} |");
    }
    if worse.is_empty() {
        return Ok(());
    }
    Err(format!("worse with what the fleet says: {}", worse.join("; ")).into())
}

/// A row of the table; tool error taught over that without.
fn row(case: &Case, trials: &[Trial]) -> f64 {
    let errors: Vec<Errors> = trials.iter().flat_map(|t| t.errors.clone()).collect();
    let (learned, known) = (of(&errors, |e| e.learned), of(&errors, |e| e.oracle));
    let without: Vec<[f64; 2]> =
        (0..WITHOUT.len()).map(|p| of(&errors, |e| e.without[p])).collect();
    let shown = |[rms, median]: &[f64; 2]| format!("{:.0} ({:.0})", rms * 1e6, median * 1e6);
    let cells: Vec<String> = without.iter().map(shown).collect();
    let [rms, median] = [0, 1].map(|which| learned[which] / without[0][which]);
    println!(
        "| {} | {} | {} | {} | {} | {} | {rms:.3} ({median:.3}) |",
        case.name,
        case.arms,
        shown(&learned),
        shown(&known),
        cells.join(" | "),
        worth(learned[0], &without.iter().map(|w| w[0]).collect::<Vec<_>>()),
    );
    rms
}

/// Poses without that give an error, between those that were tried.
fn worth(error: f64, without: &[f64]) -> String {
    let steps = without.windows(2).zip(WITHOUT.windows(2));
    for (errors, poses) in steps {
        if error <= errors[0] && error >= errors[1] {
            let share = (errors[0] / error).ln() / (errors[0] / errors[1]).ln();
            let [from, to] = [poses[0] as f64, poses[1] as f64];
            return format!("{:.1}", from * (to / from).powf(share));
        }
    }
    match error < without[WITHOUT.len() - 1] {
        true => format!("> {}", WITHOUT[WITHOUT.len() - 1]),
        false => format!("< {}", WITHOUT[0]),
    }
}

/// Fleets that name a sound arm, the crashed one, a common correction that is none;
/// common corrections found.
fn names(trials: &[Trial]) -> [usize; 4] {
    let fleets = |is: &dyn Fn(&Trial) -> bool| trials.iter().filter(|t| is(t)).count();
    [
        fleets(&|t| t.wrongly_named > 0),
        fleets(&|t| t.crashed_named),
        fleets(&|t| t.wrongly_common > 0),
        trials.iter().map(|t| t.rightly_common).sum(),
    ]
}

/// Root mean square and median.
fn of(errors: &[Errors], value: impl Fn(&Errors) -> f64) -> [f64; 2] {
    let mut all: Vec<f64> = errors.iter().map(value).collect();
    all.sort_by(f64::total_cmp);
    let square: f64 = all.iter().map(|e| e * e).sum();
    [(square / all.len() as f64).sqrt(), all[all.len() / 2]]
}
