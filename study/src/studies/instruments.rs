//! What each kind of measurement is worth: the same arms, the same effort, the
//! tool's error over the workspace, and how many it takes for 0.1 mm.

use clap::Args;
use truearm_host::model::Robot;
use truearm_simulate::robots;

use super::Result;
use crate::judged::{efficiency, once};
use crate::simulated::robot;

#[derive(Args)]
pub struct Options {
    /// Arms of each case
    #[arg(long, default_value_t = 400)]
    arms: u64,
}

/// What people compare before they buy.
const CASES: [(&str, &[(&str, usize)]); 9] = [
    ("50 tracker points", &[("point", 50)]),
    ("50 full poses", &[("pose", 50)]),
    ("200 ballbar lengths, three feet", &[("distance", 200)]),
    ("200 distances between two poses", &[("pair", 200)]),
    ("150 touches of three planes", &[("touch", 150)]),
    ("100 holes of a plate", &[("plate", 100)]),
    ("150 ranges to three planes", &[("range", 150)]),
    ("90 closures at three points", &[("closure", 90)]),
    ("60 images of a board", &[("pixel", 60)]),
];
/// Tool error that is asked for, m.
const GOAL: f64 = 1e-4;
/// Arms by which the number of poses for it is judged.
const FEW: u64 = 12;

pub fn run(options: &Options) -> Result {
    let mut missed = Vec::new();
    for (name, text) in [("6R", robots::UR10_LIKE), ("7R", robots::ALL[4])] {
        let robot = robot(text);
        println!("\n| {name}: measured | tool error, mm | of the bound | needed for 0.1 mm |");
        println!("|---|---|---|---|");
        for (what, wanted) in CASES {
            let [ratio, two_errors, bound] = efficiency(&robot, wanted, options.arms);
            let needed = needed(&robot, wanted)
                .map_or("more than 16 times as many".to_owned(), |n| n.to_string());
            let error = ratio * bound * 1e3;
            println!("| {what} | {error:.3} | {ratio:.3} +- {two_errors:.3} | {needed} |");
            if ratio > 1.03 + two_errors {
                missed.push(format!("{name}, {what}: {ratio:.3} of the bound"));
            }
        }
    }
    match missed.is_empty() {
        true => Ok(()),
        false => Err(missed.join("; ").into()),
    }
}

/// The fewest of a kind, by the bound, for the goal.
fn needed(robot: &Robot, wanted: &[(&'static str, usize)]) -> Option<usize> {
    let (kind, count) = wanted[0];
    let reached = |n: usize| {
        let bounds = (0..FEW).map(|seed| once(robot, &[(kind, n)], 1000 + seed).map(|x| x[1]));
        let sum: f64 = bounds.map(|bound| bound.unwrap_or(f64::INFINITY)).sum();
        (sum / FEW as f64).sqrt() <= GOAL
    };
    let steps = (-16..=16).map(|k| (count as f64 * 2_f64.powf(f64::from(k) / 4.0)).round());
    steps.map(|n| n as usize).filter(|n| *n >= 4).find(|n| reached(*n))
}
