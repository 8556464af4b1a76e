//! A few tracker points and many touches: do both together beat either, and does it
//! hurt when the sigma of one of them is stated wrongly?

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm_host::Result;
use truearm_host::identify::noise_estimate::noise;
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Problem, Scaling};
use truearm_host::model::{KindId, Robot};
use truearm_host::observations::measuring;

use crate::judged::{Judged, cell, most_probable, read};

const POINTS: usize = 15;
const TOUCHES: usize = 100;

/// What is fitted: with points, with touches, and by how much the sigma that is
/// stated of either is too large.
pub const FITS: [(&str, [bool; 2], [f64; 2]); 7] = [
    ("15 points", [true, false], [1.0, 1.0]),
    ("100 touches", [false, true], [1.0, 1.0]),
    ("both", [true, true], [1.0, 1.0]),
    ("both, sigma of touches stated 3 times too large", [true, true], [1.0, 3.0]),
    ("both, sigma of touches stated 3 times too small", [true, true], [1.0, 1.0 / 3.0]),
    ("both, sigma of points stated 3 times too large", [true, true], [3.0, 1.0]),
    ("both, sigma of points stated 3 times too small", [true, true], [1.0 / 3.0, 1.0]),
];

/// Squares of the tool's error of one arm, m^2: of each fit with the noise of each
/// kind estimated, and with the sigmas as they are stated.
///
/// # Errors
/// As of `identify`.
pub fn errors(robot: &Robot, seed: u64) -> Result<Vec<[f64; 2]>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let cell = cell(robot, &mut rng);
    let judged = Judged::new(&cell, &mut rng);
    let points = cell.file(&[("point", POINTS)], &mut rng);
    let touches = cell.file(&[("touch", TOUCHES)], &mut rng);
    let (header, behind) = touches.split_once('\n').unwrap_or_default();
    let of = |fit: &(&str, [bool; 2], [f64; 2])| {
        let (_, [with_points, with_touches], wrong) = fit;
        let mut text = if *with_points { points.clone() } else { format!("{header}\n") };
        if *with_touches {
            text += behind;
        }
        let mut data = read(robot, &cell, &text);
        for row in &mut data.rows {
            row.sigma *= wrong[usize::from(row.kind != KindId::default())];
        }
        let mut problem = Problem::new(&data, robot, Scaling::Prior);
        let stated = judged.error(&most_probable(&problem, robot)?.fit.state);
        let start = register(&data, &problem.nominal, robot.tool)?;
        problem.noise = noise(&problem, &measuring(&data.rows), &start)?;
        let estimated = judged.error(&most_probable(&problem, robot)?.fit.state);
        Ok([estimated, stated].map(|error| error * error))
    };
    FITS.iter().map(of).collect()
}

/// Root mean square errors of the tool over arms, m: of each of [`FITS`] with the
/// noise estimated, and with the sigmas as stated.
///
/// # Errors
/// As of `identify`.
pub fn compared(robot: &Robot, arms: u64) -> Result<Vec<[f64; 2]>> {
    let all = (0..arms).into_par_iter().map(|seed| errors(robot, seed));
    let all: Vec<Vec<[f64; 2]>> = all.collect::<Result<_>>()?;
    let mean = |fit: usize, k: usize| {
        (all.iter().map(|squares| squares[fit][k]).sum::<f64>() / arms as f64).sqrt()
    };
    Ok((0..FITS.len()).map(|fit| [mean(fit, 0), mean(fit, 1)]).collect())
}

/// By how much a wrong sigma may hurt.
const HURTS: f64 = 1.1;

/// What is not as it should be: both beat either alone, wrong sigmas do not hurt.
#[must_use]
pub fn hurt(errors: &[[f64; 2]]) -> Option<String> {
    let of = |fit: usize| errors[fit][0];
    if of(2) > of(0).min(of(1)) {
        return Some("both are no better than one".to_owned());
    }
    let wrong = (3..FITS.len()).find(|fit| of(*fit) > HURTS * of(2));
    wrong.map(|fit| format!("{} hurts", FITS[fit].0))
}
