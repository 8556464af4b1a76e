//! Probability of naming an effect against its size.

use clap::Args;

use super::Result;
use super::judged;
use crate::blind::sets::{LISTED, Wanted};

#[derive(Args)]
pub struct Options {
    /// Sets an effect and size
    #[arg(long, default_value_t = 20)]
    sets: u64,
    /// Another seed, other sets
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// RMS that geometry alone leaves, in noise floors.
const SIZES: [f64; 10] = [0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0];

pub fn run(options: &Options) -> Result {
    // Gross errors have a size of their own.
    let names: Vec<&str> = LISTED.into_iter().filter(|n| *n != "outliers").collect();
    let mut plans: Vec<(u64, Vec<Wanted>)> = Vec::new();
    for name in &names {
        for size in SIZES {
            for _ in 0..options.sets {
                let seed = (options.seed << 32) + plans.len() as u64;
                plans.push((seed, vec![(*name, [size, size])]));
            }
        }
    }
    let scores = judged(&plans)?;
    let sizes: Vec<String> = SIZES.iter().map(f64::to_string).collect();
    println!("Share of sets with the effect named, at the right joint, against its size:");
    println!("RMS that geometry alone leaves on noise-free poses, in noise floors.\n");
    println!("| effect | {} |", sizes.join(" | "));
    println!("|---|{}", "---|".repeat(SIZES.len()));
    for (name, scores) in names.iter().zip(scores.chunks(SIZES.len() * options.sets as usize)) {
        let cells: Vec<String> = scores
            .chunks(options.sets as usize)
            .map(|of| {
                let named = of.iter().filter(|s| s.joints_right()).count();
                format!("{:.2}", named as f64 / of.len() as f64)
            })
            .collect();
        println!("| {name} | {} |", cells.join(" | "));
    }
    Ok(())
}
