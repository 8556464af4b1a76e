//! Joints that scatter by themselves, and what else errs beside them.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{Outcome, Verdict};

use super::session::{SIGMA, Session, arm, diagnosed, session, still, with};
use super::simulated::vector;

/// A joint whose zero is one of two at random, which nothing that was recorded says: of
/// thousands of orders the best fits. Lines stood in each of these sessions as long as noise
/// was the same every way.
#[test]
fn scatter_of_a_joint_is_no_line() {
    for seed in 20..26 {
        let session = session(150, seed, &scattered(0), &still);
        let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
        let told: Vec<_> = outcome.effects.iter().chain(&outcome.suspected).collect();
        assert!(told.is_empty(), "{seed}: {told:?}");
        let says = |words: &str| words.contains("joint 1 scatters by 2");
        assert!(outcome.figures.warnings.iter().any(|w| says(w)), "{:?}", outcome.figures.warnings);
        assert!(!outcome.unnamed.iter().any(|w| w.contains("before it")), "{:?}", outcome.unnamed);
        // Noise that is beyond what was stated is no good arm's.
        let beyond = outcome.noise_scale > 3.0;
        assert_eq!(outcome.verdict == Verdict::Unexplained, beyond, "{seed}");
        assert_eq!(outcome.unnamed.iter().any(|w| says(w)), beyond, "{:?}", outcome.unnamed);
    }
}

/// A line of the joint that scatters, and one of another, are lines all the same; what is
/// stated of them holds.
#[test]
fn lines_beside_the_scatter_of_a_joint() {
    for seed in 30..33 {
        let waving = |q: &[f64], _: &[f64]| {
            let mut out = scattered(0)(q, &[]);
            out[0] += 5e-4 * (40.0 * q[0]).cos();
            out[2] += 3e-4 * (16.0 * q[2]).sin();
            out
        };
        let session = session(150, seed, &waving, &still);
        let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
        let lines: Vec<_> = outcome.effects.iter().map(|e| (e.order, e.joints.clone())).collect();
        assert_eq!(lines.len(), 2, "{seed}: {lines:?}");
        for (joint, order, size) in [(1, 40.0, 5e-4), (3, 16.0, 3e-4)] {
            let own = outcome.effects.iter().find(|e| e.joints == [joint]).unwrap();
            assert_eq!(own.order, Some(order), "{seed}");
            let found = own.coefficients.iter().map(|c| c.value.powi(2)).sum::<f64>().sqrt();
            let sigma = own.coefficients[0].sigma;
            assert!((found - size).abs() < 4.0 * sigma, "{seed}: {found} +- {sigma} of {size}");
        }
    }
}

/// A joint whose zero is one of two at random.
fn scattered(joint: usize) -> impl Fn(&[f64], &[f64]) -> Vec<f64> {
    move |q, _| {
        let side = if (q[joint] * 1e9) as i64 % 2 == 0 { 1.0 } else { -1.0 };
        let mut q = q.to_vec();
        q[joint] += 2.5e-4 * side;
        q
    }
}

/// Where several joints scatter none of it is a wave, and each is told, whether or not anything
/// stands for it.
#[test]
fn several_joints_scatter() {
    for seed in 40..44 {
        let both = |q: &[f64], _: &[f64]| scattered(1)(&scattered(0)(q, &[]), &[]);
        let session = session(200, seed, &both, &still);
        let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
        // In 42 a base gives way that does not, which is no wave of these joints.
        let waves = outcome.effects.iter().filter(|e| e.order.is_some()).count();
        assert_eq!(waves, 0, "{seed}: {:?}", outcome.effects);
        for joint in 1..7 {
            assert_eq!(told(&outcome, joint), joint < 3, "{seed}: {:?}", outcome.figures.warnings);
        }
    }
}

/// What is off at a pose and off as much when the arm comes back is no scatter; what is off
/// otherwise then, is.
#[test]
fn what_returns_with_the_pose_is_no_scatter() {
    for (seed, returns) in [(50, true), (51, true), (50, false), (51, false)] {
        let mut session = session(100, seed, &scattered(0), &still);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for k in 0..100 {
            let mut q = session.poses[k].clone();
            session.poses.push(q.clone());
            let sign = if returns || rng.random_bool(0.5) { 1.0 } else { -1.0 };
            q[0] += sign * (scattered(0)(&q, &[])[0] - q[0]);
            session.points.push(session.truth.point(&q, 0, 0) + vector(&mut rng) * SIGMA);
        }
        let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
        assert_eq!(told(&outcome, 1), !returns, "{seed}: {:?}", outcome.figures.warnings);
    }
}

/// So many rows in which a joint, counted from 0, is off from a row on.
fn off(
    (rows, seed): (usize, u64),
    (joint, from): (usize, usize),
    by: &dyn Fn(&mut ChaCha8Rng) -> f64,
) -> Session {
    let mut session = session(rows, seed, &|q: &[f64], _: &[f64]| q.to_vec(), &still);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for k in from..rows {
        let mut q = session.poses[k].clone();
        q[joint] += by(&mut rng);
        session.points[k] = session.truth.point(&q, 0, 0) + vector(&mut rng) * SIGMA;
    }
    session
}

/// A zero that is another from a row on is that, and no scatter beside it.
#[test]
fn a_slip_is_no_scatter() {
    for (seed, joint, row) in [(70, 1, 40), (71, 2, 60), (72, 3, 80)] {
        let session = off((120, seed), (joint, row), &|_| 5e-4);
        let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
        let any = (1..7).any(|joint| told(&outcome, joint));
        assert!(!any, "{seed}: {:?}", outcome.figures.warnings);
        let slip = format!("the zero of joint {} is another from row", joint + 1);
        assert!(outcome.unnamed.iter().any(|w| w.contains(&slip)), "{:?}", outcome.unnamed);
    }
}

/// A joint that scatters from a row on, as one does whose load is another there than was
/// written, was one whose scatter nothing says, and the model explained.
#[test]
fn scatter_that_begins_with_a_row_is_told() {
    for (seed, joint, row) in [(75, 1, 80), (76, 2, 60), (77, 0, 100)] {
        let session = off((160, seed), (joint, row), &|rng| 8e-4 * (rng.random::<f64>() - 0.5));
        let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
        let scatters = format!("joint {} scatters by ", joint + 1);
        let begins = |w: &&String| w.contains(&scatters) && w.contains("before it");
        let words = outcome.unnamed.iter().find(begins);
        let words = words.unwrap_or_else(|| panic!("{seed}: {:?}", outcome.unnamed));
        let at = words.split("from row ").nth(1).and_then(|rest| rest.split(' ').next());
        let at: usize = at.and_then(|at| at.parse().ok()).unwrap();
        assert!(at.abs_diff(row + 1) <= 10, "{words}");
        assert_eq!(outcome.verdict, Verdict::Unexplained);
    }
}

/// Whether a joint is said to scatter.
fn told(outcome: &Outcome, joint: usize) -> bool {
    let words = format!("joint {joint} scatters by ");
    outcome.figures.warnings.iter().any(|warning| warning.contains(&words))
}
