//! Do stated 95 % intervals hold the truth in 95 % of simulated identifications?

use clap::Args;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::Result;
use crate::coverage::{Cell, Tally, identified_once};

#[derive(Args)]
pub struct Options {
    /// Simulations of each case
    #[arg(long, default_value_t = 1000)]
    simulations: u64,
    /// Another seed, other arms
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Arms drawn anew in every simulation, from the prior; or one arm.
const CASES: [(usize, f64, bool); 6] = [
    (52, 2e-5, true),
    (20, 2e-5, true),
    (14, 2e-4, true),
    (52, 2e-5, false),
    (20, 2e-5, false),
    (14, 2e-4, false),
];

pub fn run(options: &Options) -> Result {
    println!("| case | intervals of | held, bias included | held, noise alone |");
    println!("|---|---|---|---|");
    let mut missed = Vec::new();
    for (poses, sigma, fresh) in CASES {
        let arms = if fresh { "arms drawn from the tolerances" } else { "one arm" };
        let name = format!("{poses} poses, sigma {} mm, {arms}", sigma * 1e3);
        let cell = Cell::new(poses, sigma, options.seed);
        let each: Vec<_> = (0..options.simulations)
            .into_par_iter()
            .map(|k| {
                let mut rng = ChaCha8Rng::seed_from_u64(options.seed << 32 | k);
                identified_once(&cell, fresh, &mut rng)
            })
            .collect();
        for (what, tally) in Tally::of(&each) {
            let [total, noise] = tally;
            println!("| {name} | {what} | {:.2} % | {:.2} % |", total * 100.0, noise * 100.0);
            if fresh && !(0.93..=0.97).contains(&total) {
                missed.push(format!("{name}, {what}: {:.2} %", total * 100.0));
            }
        }
    }
    if missed.is_empty() {
        return Ok(());
    }
    Err(format!("not within 93 to 97 %: {}", missed.join("; ")).into())
}
