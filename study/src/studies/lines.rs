//! Lines of unknown order at any number of rows: those that are there, no more.

use clap::Args;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_host::model::Measurements;

use super::Result;
use crate::simulated::{Truth, UR10_LIKE, csv_of, robot, vector};

#[derive(Args)]
pub struct Options {
    /// Arms of every number of rows
    #[arg(long, default_value_t = 4)]
    arms: u64,
    /// Numbers of rows
    #[arg(long, value_delimiter = ',', default_values_t = [1500, 5000, 20_000])]
    rows: Vec<usize>,
    /// Another seed, other arms
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Lines an arm has.
const LINES: usize = 5;
/// Standard deviation of a coordinate, m: a line of 40 urad stands out of it in 1,500 rows.
const SIGMA: f64 = 3e-5;
/// As near as a scan comes, cycles a turn.
const NEAR: f64 = 0.2;

/// A line: joint, order, amplitude in rad, phase.
type Line = (usize, f64, f64, f64);

/// How many lines there were, how many of them were named, how many others.
struct Count {
    named: usize,
    ghosts: Vec<(usize, f64)>,
}

pub fn run(options: &Options) -> Result {
    println!("| rows | lines | named | of others |\n|---|---|---|---|");
    let mut ghosts = Vec::new();
    for rows in &options.rows {
        let counts = (0..options.arms).map(|k| count(*rows, options.seed * 1000 + k));
        let counts = counts.collect::<std::result::Result<Vec<_>, String>>()?;
        let named: usize = counts.iter().map(|c| c.named).sum();
        let others: Vec<_> = counts.into_iter().flat_map(|c| c.ghosts).collect();
        println!("| {rows} | {} | {named} | {} |", LINES as u64 * options.arms, others.len());
        ghosts.extend(others);
    }
    match ghosts.is_empty() {
        true => Ok(()),
        false => Err(format!("lines that are not there (joint, cycles a turn): {ghosts:?}").into()),
    }
}

fn count(rows: usize, seed: u64) -> std::result::Result<Count, String> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut arm = robot(UR10_LIKE);
    arm.sigma = SIGMA;
    let truth = Truth::draw(&arm, 1, 1, &mut rng);
    let lines = drawn(&mut rng);
    let pose = |rng: &mut ChaCha8Rng| {
        let degrees = |_| (rng.random_range(-145.0..145.0_f64) * 1e4).round() / 1e4;
        (0..6).map(degrees).map(f64::to_radians).collect::<Vec<f64>>()
    };
    let poses: Vec<Vec<f64>> = (0..rows).map(|_| pose(&mut rng)).collect();
    let seen = |q: &Vec<f64>| {
        let mut real = q.clone();
        for (joint, order, size, phase) in &lines {
            real[*joint] += size * (order * q[*joint] + phase).sin();
        }
        truth.point(&real, 0, 0) + vector(&mut rng) * SIGMA
    };
    let points: Vec<_> = poses.iter().map(seen).collect();
    let text = csv_of(&arm, &poses, &points);
    let data = Measurements::parse("m.csv".as_ref(), &text, &arm).map_err(|e| e.to_string())?;
    let found = diagnose(&arm, &data, None, &DiagnoseOptions::default(), &|_| ());
    let found = found.map_err(|e| format!("{rows} rows, seed {seed}: {e}"))?;
    let report = found.outcome.effects.into_iter().chain(found.outcome.suspected);
    let told = report.filter_map(|e| Some((e.joints, e.order?)));
    let told: Vec<(usize, f64)> =
        told.flat_map(|(joints, order)| joints.into_iter().map(move |j| (j - 1, order))).collect();
    let is = |(joint, order): &(usize, f64), line: &Line| {
        *joint == line.0 && (order - line.1).abs() < NEAR
    };
    let named = lines.iter().filter(|line| told.iter().any(|t| is(t, line))).count();
    let other = |t: &(usize, f64)| lines.iter().filter(|line| is(t, line)).count() != 1;
    let twice =
        |k: usize| told[..k].iter().any(|t| lines.iter().any(|l| is(t, l) && is(&told[k], l)));
    let ghosts = (0..told.len()).filter(|k| other(&told[*k]) || twice(*k)).map(|k| told[k]);
    Ok(Count { named, ghosts: ghosts.collect() })
}

/// Lines as gears have them, at different places.
fn drawn(rng: &mut ChaCha8Rng) -> Vec<Line> {
    const ORDERS: [f64; 8] = [30.0, 50.0, 64.0, 100.0, 128.0, 161.0, 202.0, 240.0];
    let orders: Vec<f64> = ORDERS.sample(rng, LINES).copied().collect();
    let one = |order: f64| {
        let size = rng.random_range(3e-5..1.2e-4);
        (rng.random_range(0..5), order, size, rng.random_range(0.0..std::f64::consts::TAU))
    };
    orders.into_iter().map(one).collect()
}
