//! Poses that leave unknowns undetermined are no reason to refuse: a hand that
//! never turns, joints that stand still.

use std::path::Path;

use crate::simulated::{Truth, csv_of, parse, rms, robot, state_of, vector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::identify::{Options, identify};
use truearm_host::model::{Measurements, Robot};
use truearm_simulate::robots;

const SIGMA: f64 = 3e-5;

/// RMS over sigma at other poses of the same kind: these joints within a tenth
/// of a degree (0.1 mm) of one place.
fn reached(text: &str, still: impl Fn(usize, usize) -> bool, seed: u64) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let truth = Truth::draw(&robot(text), 1, 1, &mut rng);
    let n = truth.robot.joints.len();
    let place: Vec<f64> = (0..n).map(|_| rng.random_range(-0.4..0.4)).collect();
    let width = |j: usize| if still(j, n) { 0.0017 } else { 0.9 };
    let mut poses = |count: usize| -> Vec<Vec<f64>> {
        let one = |rng: &mut ChaCha8Rng| -> Vec<f64> {
            (0..n).map(|j| place[j] + width(j) * rng.random_range(-1.0..1.0)).collect()
        };
        (0..count).map(|_| one(&mut rng)).collect()
    };
    let (training, others) = (poses(60), poses(60));
    let mut points = |poses: &[Vec<f64>]| {
        let one = |q: &Vec<f64>| truth.point(q, 0, 0) + vector(&mut rng) * SIGMA;
        let points: Vec<_> = poses.iter().map(one).collect();
        parse(&truth.robot, &csv_of(&truth.robot, poses, &points))
    };
    let (data, check) = (points(&training), points(&others));
    let found = identify(&truth.robot, &data, &Options::default(), &|_, _| ());
    let found = found.unwrap_or_else(|e| panic!("{}: {e}", truth.robot.name));
    rms(&truth.robot, &state_of(&found, &check), &check) / (3.0_f64.sqrt() * SIGMA)
}

#[test]
fn what_stands_still_does_not_stop_a_fit() {
    for (k, text) in robots::ALL.iter().enumerate() {
        for seed in 0..3 {
            let seed = 10 * k as u64 + seed;
            for (what, still) in [
                ("hand", (|j, n| j + 3 >= n) as fn(usize, usize) -> bool),
                ("last", |j, n| j + 1 == n),
                ("first", |j, _| j == 0),
                ("all but two", |j, _| j != 1 && j != 2),
            ] {
                let ratio = reached(text, still, seed);
                assert!((0.7..1.6).contains(&ratio), "arm {k}, {what}, seed {seed}: {ratio}");
            }
        }
    }
}

/// 400 poses within 15 to 50 degrees a joint of an arm on a rail, whose springs and gears err
/// by 12 times the noise: at the stated noise the links that fit best are 300 tolerances off.
#[test]
fn many_rows_at_few_angles_are_not_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cone");
    let robot = Robot::read(&folder.join("robot.toml")).unwrap();
    let data = Measurements::read(&folder.join("measurements.csv"), &robot).unwrap();
    let found = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap();
    let nominal = found.figures.nominal.unwrap().rms_mm;
    let held_out = found.figures.cross_validated.unwrap().rms_mm;
    assert!(nominal > 1.0 && held_out < 0.6, "{nominal} {held_out}");
}
