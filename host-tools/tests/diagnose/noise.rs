//! Noise of the instrument that is not the same every way, or has tails.

use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{Outcome, Verdict};
use truearm_host::effects::OUTLIERS;

use super::session::{Readings, Real, SIGMA, arm, diagnosed, session_of, still, with};
use super::simulated::vector;

const TRACKER: Vector3<f64> = Vector3::new(2.5, -1.5, 0.4);

/// What is said of a session whose base is seen there, m, with more noise at each point.
fn seen(
    (rows, seed): (usize, u64),
    base: Vector3<f64>,
    real: &Real,
    more: &dyn Fn(&Vector3<f64>, &mut ChaCha8Rng) -> Vector3<f64>,
) -> Outcome {
    seen_often((Readings::once(rows), seed), base, real, more)
}

/// The same of poses that are read several times.
fn seen_often(
    (readings, seed): (Readings, u64),
    base: Vector3<f64>,
    real: &Real,
    more: &dyn Fn(&Vector3<f64>, &mut ChaCha8Rng) -> Vector3<f64>,
) -> Outcome {
    let mut session = session_of(readings, seed, real, &still);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let own = session.truth.state().bases[0].translation;
    for point in &mut session.points {
        *point += base - own;
        *point += more(point, &mut rng);
    }
    diagnosed(&arm(), &with(&session, "", |_| String::new()))
}

fn said(outcome: &Outcome, words: &str) -> bool {
    outcome.figures.warnings.iter().any(|warning| warning.contains(words))
}

/// A laser tracker reads angles worse than distances: two joints scattered for it.
#[test]
fn a_sight_scatters_and_no_joint_for_it() {
    let unmoved = |q: &[f64], _: &[f64]| q.to_vec();
    let sight = |point: &Vector3<f64>, rng: &mut ChaCha8Rng| (vector(rng) * 25e-6).cross(point);
    for seed in 80..84 {
        let outcome = seen((250, seed), TRACKER, &unmoved, &sight);
        assert!(said(&outcome, "points scatter by "), "{:?}", outcome.figures.warnings);
        assert!(!said(&outcome, "joint "), "{:?}", outcome.figures.warnings);
        assert_eq!(outcome.verdict, Verdict::Clean, "{:?}", outcome.unnamed);
    }
}

/// The same tracker, told to write its points in the robot's coordinates: where it stands is found.
#[test]
fn a_sight_scatters_in_coordinates_of_the_robot() {
    let unmoved = |q: &[f64], _: &[f64]| q.to_vec();
    let sight = |point: &Vector3<f64>, rng: &mut ChaCha8Rng| {
        (vector(rng) * 25e-6).cross(&(point - TRACKER))
    };
    for seed in 80..84 {
        let outcome = seen((250, seed), Vector3::zeros(), &unmoved, &sight);
        assert!(said(&outcome, " m of their coordinates"), "{:?}", outcome.figures.warnings);
        assert!(!said(&outcome, "joint "), "{:?}", outcome.figures.warnings);
        assert_eq!(outcome.verdict, Verdict::Clean, "{:?}", outcome.unnamed);
    }
}

/// Twenty poses of four readings and sixty of three, the arm away in between or not: what each
/// reading scatters across the sight is seen, and nothing is made of it. Formulas that knew only of
/// the means of poses, and of the determinants of all readings, never found it, and steps and
/// drifts stood for it.
#[test]
fn a_sight_scatters_before_poses_that_are_read_often() {
    let unmoved = |q: &[f64], _: &[f64]| q.to_vec();
    let sight = |point: &Vector3<f64>, rng: &mut ChaCha8Rng| (vector(rng) * 4e-5).cross(point);
    for (poses, times) in [(20, 4), (60, 3)] {
        for (seed, in_rounds) in [(80, false), (81, true), (82, false), (83, true)] {
            let readings = Readings { poses, times, in_rounds };
            let outcome = seen_often((readings, seed), TRACKER, &unmoved, &sight);
            let warnings = &outcome.figures.warnings;
            assert!(said(&outcome, "points scatter by "), "{readings:?} {seed}: {warnings:?}");
            assert!(!said(&outcome, "joint "), "{readings:?} {seed}: {warnings:?}");
            assert_eq!(outcome.verdict, Verdict::Clean, "{readings:?}: {:?}", outcome.unnamed);
        }
    }
}

/// A camera sees how far away a target is worse than where: joints scattered for it, and what lies
/// across its sight seemed to.
#[test]
fn a_distance_scatters_and_no_joint_for_it() {
    let unmoved = |q: &[f64], _: &[f64]| q.to_vec();
    let mut unexplained = Vec::new();
    for (base, first) in [(TRACKER, 80), (Vector3::zeros(), 90)] {
        let depth = |point: &Vector3<f64>, rng: &mut ChaCha8Rng| {
            let from = if base == TRACKER { Vector3::zeros() } else { TRACKER };
            (point - from) * (vector(rng)[0] * 5e-5)
        };
        for readings in [Readings::once(150), Readings { poses: 40, times: 4, in_rounds: false }] {
            for seed in first..first + 3 {
                let outcome = seen_often((readings, seed), base, &unmoved, &depth);
                let warnings = &outcome.figures.warnings;
                assert!(said(&outcome, ", along it and "), "{readings:?} {seed}: {warnings:?}");
                assert!(!said(&outcome, "joint "), "{readings:?} {seed}: {warnings:?}");
                if outcome.verdict != Verdict::Clean {
                    unexplained.push((readings, seed, outcome.unnamed));
                }
            }
        }
    }
    // What is told at 0.6 may be wrong: of 20 seeds from 80 on something is in one.
    assert!(unexplained.len() < 2, "{unexplained:?}");
}

/// A joint that comes to rest elsewhere each time, read several times while it rests: its readings
/// tell nothing of it but together.
#[test]
fn a_joint_scatters_whose_poses_are_read_often() {
    let nothing = |_: &Vector3<f64>, _: &mut ChaCha8Rng| Vector3::zeros();
    let loose = |q: &[f64], _: &[f64]| {
        let side = if (q[2] * 1e9) as i64 % 2 == 0 { 2e-4 } else { -2e-4 };
        q.iter().enumerate().map(|(k, q)| if k == 2 { q + side } else { *q }).collect()
    };
    for (poses, times, seed) in [(60, 3, 90), (60, 5, 91), (120, 2, 92)] {
        let readings = Readings { poses, times, in_rounds: false };
        let outcome = seen_often((readings, seed), TRACKER, &loose, &nothing);
        let warnings = &outcome.figures.warnings;
        assert!(said(&outcome, "joint 3 scatters by "), "{readings:?}: {warnings:?}");
        assert!(!said(&outcome, "points scatter by "), "{readings:?}: {warnings:?}");
    }
}

/// Joints that scatter are no sight: not where an instrument stands, and not at the base, round
/// which joints 1 and 2 turn targets as a sight there would.
#[test]
fn joints_that_scatter_are_no_sight() {
    let nothing = |_: &Vector3<f64>, _: &mut ChaCha8Rng| Vector3::zeros();
    let loose = |q: &[f64], _: &[f64]| {
        // Of bits that nothing recorded goes with.
        let side = |q: f64| if (q * 1e9) as i64 % 2 == 0 { 2.5e-4 } else { -2.5e-4 };
        let mut out = q.to_vec();
        (0..2).for_each(|k| out[k] += side(q[k]));
        out
    };
    for (seed, base) in
        [(90, TRACKER), (91, TRACKER), (90, Vector3::zeros()), (91, Vector3::zeros())]
    {
        let outcome = seen((200, seed), base, &loose, &nothing);
        let warnings = &outcome.figures.warnings;
        assert!(!said(&outcome, "points scatter by "), "{seed}: {warnings:?}");
        for joint in 1..7 {
            let told = said(&outcome, &format!("joint {joint} scatters by "));
            assert_eq!(told, joint < 3, "{seed}: {warnings:?}");
        }
    }
}

/// Student's t of four degrees of freedom: rows beyond eight standard deviations of the core were
/// gross errors at a probability of 1, and the verdict `explained`. One that is far beyond these
/// is.
#[test]
fn ends_of_tails_are_left_out_and_are_no_gross_errors() {
    let unmoved = |q: &[f64], _: &[f64]| q.to_vec();
    let tails = |_: &Vector3<f64>, rng: &mut ChaCha8Rng| {
        let core: f64 = (0..4).map(|_| vector(rng)[0].powi(2)).sum::<f64>() / 4.0;
        vector(rng) * 3.0 * SIGMA / core.sqrt()
    };
    let named = |outcome: &Outcome| outcome.effects.iter().any(|e| e.name == OUTLIERS);
    let mut left_out = 0;
    for seed in 60..68 {
        let outcome = seen((250, seed), TRACKER, &unmoved, &tails);
        assert!(!named(&outcome), "{seed}: {:?}", outcome.figures.outlier_rows);
        assert_eq!(outcome.verdict, Verdict::Clean, "{seed}: {:?}", outcome.unnamed);
        left_out += outcome.figures.outlier_rows.len();
        let once = std::cell::Cell::new(true);
        let far = |point: &Vector3<f64>, rng: &mut ChaCha8Rng| {
            let off = if once.replace(false) { 0.02 } else { 0.0 };
            tails(point, rng) + Vector3::new(0.0, off, 0.0)
        };
        let outcome = seen((250, seed), TRACKER, &unmoved, &far);
        assert!(named(&outcome), "{seed}: {:?}", outcome.figures.outlier_rows);
    }
    assert!(left_out > 0);
}
