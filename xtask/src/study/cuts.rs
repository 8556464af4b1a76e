//! The power fails at every operation of a store, and again at every operation
//! of what follows.

use clap::Args;
use rayon::prelude::*;

use super::rig::cells::{EccPart, EepromPart, NorPart, Part};
use super::rig::cuts::{Bench, Blobs, Start, Tally};
use crate::run::Result;

#[derive(Args)]
pub struct Options {
    /// Second cuts after each first one of a six-joint blob, and of a short
    /// blob in words of one byte; elsewhere all of them are tried
    #[arg(long, default_value_t = 20)]
    sample: usize,
    /// Of the random bits and of the sample
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

pub fn run(options: &Options) -> Result {
    let Options { sample, seed } = *options;
    println!("| part | blob | one cut | two cuts | power cuts | blobs lost or mixed |");
    println!("|---|---|---|---|---|---|");
    let some = Some(sample);
    let total = part::<NorPart<1, 64>>(false, some, seed)
        + part::<NorPart<4, 128>>(false, None, seed)
        + part::<NorPart<8, 512>>(false, None, seed)
        + part::<NorPart<32, 256>>(false, None, seed)
        + part::<EepromPart<8>>(false, None, seed)
        + part::<EepromPart<32>>(false, None, seed)
        + part::<EccPart<8, 512>>(false, None, seed)
        + part::<EccPart<32, 256>>(false, None, seed)
        + part::<NorPart<1, 1024>>(true, some, seed)
        + part::<NorPart<4, 1024>>(true, some, seed)
        + part::<NorPart<8, 1024>>(true, some, seed)
        + part::<NorPart<32, 1024>>(true, some, seed)
        + part::<EepromPart<32>>(true, some, seed)
        + part::<EccPart<32, 1024>>(true, some, seed);
    println!("{} power cuts in {} runs", total.cuts, total.single + total.double);
    Ok(())
}

/// A broken promise panics and says in which run.
fn part<P: Part>(full: bool, sample: Option<usize>, seed: u64) -> Tally {
    let tally = Start::ALL
        .into_par_iter()
        .map(|start| {
            let blobs = if full { Blobs::full(4) } else { Blobs::small(4) };
            let bench = Bench::<P>::new(start, blobs);
            let cuts = (0..bench.operations()).map(|at| bench.cut_at(at, sample, seed));
            cuts.fold(Tally::default(), |sum, tally| sum + tally)
        })
        .reduce(Tally::default, |a, b| a + b);
    let blob = if full { "6 joints" } else { "1 joint" };
    println!("| {} | {blob} | {} | {} | {} | 0 |", P::NAME, tally.single, tally.double, tally.cuts);
    tally
}
