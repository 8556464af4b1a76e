//! Every flipped bit and every pair of flipped bits of a full blob, each really
//! given to the check that a controller runs; and bursts.

use std::fs;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm::blob::{Blob, sign};

use crate::run::Result;
use crate::vectors::shipped_terms;

const BURSTS: u64 = 10_000_000;

pub fn run() -> Result {
    let plain = fs::read(shipped_terms().blob)?;
    let mut tagged = [&plain[..], &[0; 32]].concat();
    sign(&mut tagged, &[7; 32])?;
    for (name, blob) in [("without a tag", plain), ("with a tag", tagged)] {
        // In a slot of erased flash, where a longer blob could be mistaken.
        let bits = blob.len() * 8;
        let slot = [&blob[..], &[0xff; 4096]].concat();
        Blob::check(&slot)?;
        let passed: u64 = (0..bits)
            .into_par_iter()
            .map_with(slot.clone(), |slot, first| {
                flip(slot, first);
                let mut passed = u64::from(Blob::check(slot).is_ok());
                for second in first + 1..bits {
                    flip(slot, second);
                    passed += u64::from(Blob::check(slot).is_ok());
                    flip(slot, second);
                }
                flip(slot, first);
                passed
            })
            .sum();
        let pairs = bits * (bits - 1) / 2;
        println!("{name}: {bits} bits, {bits} flips and {pairs} pairs tried, {passed} accepted");

        let accepted: u64 = (0..64_u64)
            .into_par_iter()
            .map_with(slot, |slot, seed| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let burst = |_| {
                    let length = rng.random_range(1..=32);
                    let start = rng.random_range(0..=bits - length);
                    let pattern = rng.random::<u32>() | 1 | 1 << (length - 1);
                    let hit = |slot: &mut [u8]| {
                        (0..length)
                            .filter(|k| pattern >> k & 1 != 0)
                            .for_each(|k| flip(slot, start + k));
                    };
                    hit(slot);
                    let accepted = Blob::check(slot).is_ok();
                    hit(slot);
                    u64::from(accepted)
                };
                (0..BURSTS / 64).map(burst).sum::<u64>()
            })
            .sum();
        println!("{name}: {BURSTS} bursts up to 32 bits tried, {accepted} accepted");
        if passed + accepted > 0 {
            return Err("a damaged blob was accepted".into());
        }
    }
    Ok(())
}

fn flip(bytes: &mut [u8], bit: usize) {
    bytes[bit / 8] ^= 1 << (bit % 8);
}
