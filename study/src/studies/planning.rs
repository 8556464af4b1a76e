//! Do 20 planned poses determine the tool point better than 30 random ones, and
//! how far are they from the best that any could?

use clap::Args;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::Result;
use crate::planning::{PLANNED, RANDOM, Trial};

#[derive(Args)]
pub struct Options {
    /// Arms
    #[arg(long, default_value_t = 50)]
    robots: u64,
    /// Simulated identifications of each, from each set of poses
    #[arg(long, default_value_t = 1000)]
    simulations: usize,
    /// Another seed, other arms
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

pub fn run(options: &Options) -> Result {
    let outcomes: Vec<_> = (0..options.robots)
        .into_par_iter()
        .map(|k| {
            let trial = Trial::draw(options.seed * 6000 + k);
            let mut rng = ChaCha8Rng::seed_from_u64(options.seed << 32 | k);
            let outcome = trial.simulate(options.simulations, &mut rng);
            (trial.robot.name.clone(), trial.plan.parameters, trial.plan.worst, outcome)
        })
        .collect();
    println!("worst tool point, um: {PLANNED} planned, predicted and simulated; {RANDOM} random");
    for (name, parameters, predicted, o) in &outcomes {
        println!(
            "  {name:30} p {parameters}  {:6.1} {:6.1}  {:6.1}  planned / bound {:.3}",
            predicted * 1e6,
            o.planned * 1e6,
            o.random * 1e6,
            o.planned / o.bound
        );
    }
    let better = outcomes.iter().filter(|(_, _, _, o)| o.planned < o.random).count();
    let within = outcomes.iter().filter(|(_, _, _, o)| o.planned <= 1.25 * o.bound).count();
    let mut ratios: Vec<f64> = outcomes.iter().map(|(_, _, _, o)| o.planned / o.bound).collect();
    ratios.sort_by(f64::total_cmp);
    let mut gains: Vec<f64> = outcomes.iter().map(|(_, _, _, o)| o.random / o.planned).collect();
    gains.sort_by(f64::total_cmp);
    let (count, middle) = (outcomes.len(), outcomes.len() / 2);
    println!("{PLANNED} planned beat {RANDOM} random for {better} of {count} arms");
    println!("random / planned: median {:.2}, least {:.2}", gains[middle], gains[0]);
    println!("within 1.25 of sigma sqrt(p / n): {within} of {count}");
    println!("planned / bound: median {:.3}, largest {:.3}", ratios[middle], ratios[count - 1]);
    if 50 * better < 48 * count || within < count {
        return Err("fewer than required".into());
    }
    Ok(())
}
