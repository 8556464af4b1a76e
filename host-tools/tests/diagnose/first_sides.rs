//! Gaps of joints in rows whose sides the order does not tell: the first of a session, of a
//! series, and of joints that wait.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{Outcome, Verdict};

use super::other_arms::explained;
use super::session::{SIGMA, Session, arm, diagnosed, names, with};
use crate::simulated::{Truth, vector};

/// Random poses of series of so many rows each, before which the arm was elsewhere; half gaps of
/// joints, rad.
fn sessions(seed: u64, series: &[usize], gaps: &[(usize, f64)]) -> (Session, Vec<usize>) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let truth = Truth::draw(&arm(), 1, 1, &mut rng);
    let pose = |rng: &mut ChaCha8Rng| {
        let degrees = |_| (rng.random_range(-140.0..140.0_f64) * 1e4).round() / 1e4;
        (0..6).map(degrees).map(f64::to_radians).collect::<Vec<f64>>()
    };
    let (mut poses, mut points, mut of) = (Vec::new(), Vec::new(), Vec::new());
    for (label, rows) in series.iter().enumerate() {
        let mut before = pose(&mut rng);
        for _ in 0..*rows {
            let q = pose(&mut rng);
            let mut real = q.clone();
            gaps.iter().for_each(|(j, half)| real[*j] -= (q[*j] - before[*j]).signum() * half);
            points.push(truth.point(&real, 0, 0) + vector(&mut rng) * SIGMA);
            poses.push(q.clone());
            of.push(label);
            before = q;
        }
    }
    (Session { truth, poses, points }, of)
}

/// What is said of them where nothing says where joints came from.
fn told(seed: u64, series: &[usize], gaps: &[(usize, f64)]) -> Outcome {
    let (session, of) = sessions(seed, series, gaps);
    let cells = |k: usize| format!("{},{}", of[k], 40 * k);
    diagnosed(&arm(), &with(&session, "series,time_s", cells))
}

/// A row of an unknown side is off by as much as the others, and is no gross error; nothing is
/// made up for it.
#[test]
fn the_first_row_of_a_series_is_no_gross_error() {
    for seed in 41..45 {
        let said = told(seed, &[50, 50], &[(1, 5e-4), (2, 2e-4)]);
        assert_eq!(names(&said), [("backlash", vec![2, 3])], "{seed}: {:?}", said.suspected);
        assert!(said.figures.outliers.is_empty(), "{seed}");
        assert_eq!(said.verdict, Verdict::Explained, "{seed}: {:?}", said.unnamed);
        let halves = said.effects.iter().flat_map(|e| &e.coefficients).map(|c| c.value);
        for (half, truth) in halves.zip([5e-4, 2e-4]) {
            assert!((half - truth).abs() < 1.5e-5, "{seed}: {half} for {truth}");
        }
    }
}

/// Where every third row is the first of a series, sides that may be chosen make no gap of noise,
/// and a gap is found.
#[test]
fn sides_that_may_be_chosen_make_no_gap() {
    for seed in 51..54 {
        let clean = told(seed, &[3; 24], &[]);
        assert_eq!(names(&clean), [], "{seed}");
        assert_eq!(clean.verdict, Verdict::Clean, "{seed}: {:?}", clean.unnamed);
        let gap = told(seed, &[3; 24], &[(1, 2e-4)]);
        assert_eq!(names(&gap), [("backlash", vec![2])], "{seed}: {:?}", gap.suspected);
        assert_eq!(gap.verdict, Verdict::Explained, "{seed}: {:?}", gap.unnamed);
        assert!(gap.figures.outliers.is_empty(), "{seed}");
    }
}

/// A row that no side of any gap explains stays wrong.
#[test]
fn a_first_row_that_is_wrong_is_a_gross_error() {
    let (mut session, of) = sessions(61, &[40, 40], &[(1, 3e-4)]);
    session.points[40].z += 6e-3;
    let cells = |k: usize| format!("{},{}", of[k], 40 * k);
    let said = diagnosed(&arm(), &with(&session, "series,time_s", cells));
    let rows: Vec<usize> = said.figures.outliers.iter().map(|o| o.row).collect();
    assert_eq!(rows, [41], "{:?}", names(&said));
}

/// In the first cone joint 2 had not moved yet, and beside geometry alone another side fits it
/// better: "the zero of joint 2 is another from row 8 on" had been said of a coupling and a gap,
/// and other poses were missed by 2.2 times what is attainable.
#[test]
fn sides_are_told_again_beside_what_is_found() {
    let said = explained("cones-and-gap", 0.0394);
    let all = names(&said);
    assert!(all.contains(&("backlash", vec![2])), "{all:?}");
}
