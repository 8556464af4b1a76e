//! Few poses read several times say what one reading of each says, and a little better.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, Outcome, Verdict, diagnose};
use truearm_host::model::Measurements;

use crate::simulated::{Truth, UR10_LIKE, csv_of, robot, vector};

const SIGMA: f64 = 3e-5;

/// So many poses of an arm, each read so often, cycle after cycle; its joints really are where
/// `real` says.
fn read(poses: usize, times: usize, seed: u64, real: &dyn Fn(&mut [f64])) -> Outcome {
    let mut robot = robot(UR10_LIKE);
    robot.sigma = SIGMA;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let truth = Truth::draw(&robot, 1, 1, &mut rng);
    let mut pose = || -> Vec<f64> {
        let degrees = (0..6).map(|_| rng.random_range(-140.0..140.0_f64));
        degrees.map(|d| ((d * 1e4).round() / 1e4).to_radians()).collect()
    };
    let once: Vec<Vec<f64>> = (0..poses).map(|_| pose()).collect();
    let all: Vec<Vec<f64>> = (0..times).flat_map(|_| once.clone()).collect();
    let points: Vec<Vector3<f64>> = all
        .iter()
        .map(|q| {
            let mut q = q.clone();
            real(&mut q);
            truth.point(&q, 0, 0) + vector(&mut rng) * SIGMA
        })
        .collect();
    let text = csv_of(&robot, &all, &points);
    let data = Measurements::parse("m.csv".as_ref(), &text, &robot).unwrap();
    diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap().outcome
}

/// A line of about five noise floors was found in 40 poses read once and lost in the same
/// poses read twice: the scan counted every reading, the geometry that was projected off one.
#[test]
fn a_line_is_found_however_often_poses_were_read() {
    for times in 1..=4 {
        let outcome = read(40, times, 5, &|q| q[0] += 2.5e-4 * (3.0 * q[0] + 0.4).sin());
        let names: Vec<_> =
            outcome.effects.iter().map(|e| (e.name, e.joints.clone(), e.order)).collect();
        assert_eq!(names, [("joint-periodic-error", vec![1], Some(3.0))], "{times} readings");
        assert_eq!(outcome.verdict, Verdict::Explained);
        let size = outcome.effects[0].coefficients.iter().map(|c| c.value.powi(2)).sum::<f64>();
        assert!((size.sqrt() - 2.5e-4).abs() < 2e-5, "{times} readings: {size}");
        assert!((0.8..1.5).contains(&outcome.noise_scale), "{}", outcome.noise_scale);
    }
}

/// Among hundreds of columns some explain all of what twenty poses leave, down to a twentieth
/// of what their readings scatter.
#[test]
fn nothing_is_found_in_few_poses_of_a_sound_arm() {
    for seed in 10..16 {
        let outcome = read(20, 3, seed, &|_| ());
        assert!(outcome.effects.is_empty(), "seed {seed}: {:?}", outcome.effects);
        assert_eq!(outcome.verdict, Verdict::Clean, "seed {seed}: {:?}", outcome.unnamed);
        assert!(outcome.noise_scale > 0.4, "seed {seed}: {}", outcome.noise_scale);
    }
}
