//! Do stated 95 % intervals hold the truth in 95 % of simulated identifications?

use clap::Args;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm_host::identify::LambdaRule;

use super::Result;
use crate::coverage::{Cell, Noise, Tally, identified_once};

#[derive(Args)]
pub struct Options {
    /// Simulations of each case
    #[arg(long, default_value_t = 1000)]
    simulations: u64,
    /// Another seed, other arms
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Poses, their sigma, m, and whether arms are drawn anew in every simulation, from
/// the prior, or one arm is identified again and again.
const CASES: [(usize, f64, bool); 6] = [
    (52, 2e-5, true),
    (20, 2e-5, true),
    (14, 2e-4, true),
    (52, 2e-5, false),
    (20, 2e-5, false),
    (14, 2e-4, false),
];
/// Sizes of errors, in tolerances, that the rule by default has to find out.
const SIZES: [f64; 4] = [0.3, 1.0, 3.0, 10.0];

/// Noise that is not each reading's own, and normal, as stated.
const NOISES: [(Noise, &str); 5] = [
    (Noise::Common(3, 0.9), "read 3 times, 90 % in common"),
    (Noise::Common(5, 0.5), "read 5 times, 50 % in common"),
    (Noise::Common(5, 0.0), "read 5 times, nothing in common"),
    (Noise::Common(30, 0.97), "read 30 times, 97 % in common"),
    (Noise::Tails, "tails of Student's t"),
];

pub fn run(options: &Options) -> Result {
    println!("| case | intervals of | held, bias included | held, noise alone |");
    println!("|---|---|---|---|");
    let mut missed = Vec::new();
    for (poses, sigma, fresh) in CASES {
        let arms = if fresh { "arms drawn from the tolerances" } else { "one arm" };
        let cell = Cell::new(poses, sigma, options.seed);
        for (name, total) in case(options, &cell, fresh, (poses, sigma), arms) {
            if fresh && !(0.93..=0.97).contains(&total) {
                missed.push(format!("{name}: {:.2} %", total * 100.0));
            }
        }
    }
    for (poses, sigma, _) in CASES.into_iter().filter(|(_, _, fresh)| *fresh) {
        for size in SIZES {
            let arms = format!("arms of {size} tolerances, lambda by default");
            let rule = LambdaRule::default();
            let cell = Cell::made(size, rule, (poses, sigma), options.seed);
            for (name, total) in case(options, &cell, true, (poses, sigma), &arms) {
                if total < 0.93 {
                    missed.push(format!("{name}: {:.2} %", total * 100.0));
                }
            }
        }
    }
    for (noise, what) in NOISES {
        let (poses, sigma) = (30, 3e-5);
        let cell = Cell::new(poses, sigma, options.seed).noisy(noise);
        for (name, total) in case(options, &cell, true, (poses, sigma), what) {
            if !(0.93..=0.98).contains(&total) {
                missed.push(format!("{name}: {:.2} %", total * 100.0));
            }
        }
    }
    if missed.is_empty() {
        return Ok(());
    }
    Err(format!("not within 93 to 97 %: {}", missed.join("; ")).into())
}

/// Rows of the table; the shares that held, bias included.
fn case(
    options: &Options,
    cell: &Cell,
    fresh: bool,
    (poses, sigma): (usize, f64),
    arms: &str,
) -> Vec<(String, f64)> {
    let each: Vec<_> = (0..options.simulations)
        .into_par_iter()
        .map(|k| {
            let mut rng = ChaCha8Rng::seed_from_u64(options.seed << 32 | k);
            identified_once(cell, fresh, &mut rng)
        })
        .collect();
    let name = format!("{poses} poses, sigma {:.2} mm, {arms}", sigma * 1e3);
    let rows = Tally::of(&each).into_iter().map(|(what, [total, noise])| {
        println!("| {name} | {what} | {:.2} % | {:.2} % |", total * 100.0, noise * 100.0);
        (format!("{name}, {what}"), total)
    });
    rows.collect()
}
