//! Joint values that were written with few digits, and gross errors where poses are read twice.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{Outcome, Verdict};

use super::session::{SIGMA, Session, arm, diagnosed, names, session, still, with};
use super::simulated::vector;

/// A session whose points are those of angles that its file has no digits for.
fn rounded(seed: u64, digits: i32) -> Session {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut session = session(100, seed, &|q: &[f64], _: &[f64]| q.to_vec(), &still);
    let last = 10f64.powi(digits);
    for (q, point) in session.poses.iter_mut().zip(&mut session.points) {
        q.iter_mut().for_each(|q| *q += rng.random_range(-0.5..0.5) * (1.0 / last).to_radians());
        *point = session.truth.point(q, 0, 0) + vector(&mut rng) * SIGMA;
        q.iter_mut().for_each(|q| *q = ((q.to_degrees() * last).round() / last).to_radians());
    }
    session
}

fn says(outcome: &Outcome, words: &str) -> bool {
    outcome.figures.warnings.iter().any(|warning| warning.contains(words))
}

/// 0.01 degrees scatter a joint by 50 urad, and the target by as much as the noise here: that
/// is said, whether a joint stands out or not. A ten-thousandth is no matter, nor are angles
/// that were asked for and are round by themselves.
#[test]
fn rounded_angles_are_told() {
    for seed in 80..84 {
        let outcome = diagnosed(&arm(), &with(&rounded(seed, 2), "", |_| String::new()));
        assert!(says(&outcome, "written to 0.01 degrees"), "{:?}", outcome.figures.warnings);
        assert!(!says(&outcome, "brake, servo"), "{:?}", outcome.figures.warnings);
        assert!(names(&outcome).is_empty(), "{seed}: {:?}", outcome.effects);
        let outcome = diagnosed(&arm(), &with(&rounded(seed, 4), "", |_| String::new()));
        assert!(!says(&outcome, "digits"), "{:?}", outcome.figures.warnings);
        let mut whole = session(100, seed, &|q: &[f64], _: &[f64]| q.to_vec(), &still);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for (q, point) in whole.poses.iter_mut().zip(&mut whole.points) {
            q.iter_mut().for_each(|q| *q = q.to_degrees().round().to_radians());
            *point = whole.truth.point(q, 0, 0) + vector(&mut rng) * SIGMA;
        }
        let outcome = diagnosed(&arm(), &with(&whole, "", |_| String::new()));
        assert!(!says(&outcome, "digits"), "{:?}", outcome.figures.warnings);
        assert_eq!(outcome.verdict, Verdict::Clean, "{:?}", outcome.unnamed);
    }
}

/// Eight mistakes of the second time that poses are read were neighbours in the order of the
/// rows, as all other poses stood there by their first time: structure, without a word why.
#[test]
fn gross_errors_of_a_second_pass_are_no_crowd() {
    for seed in 90..93 {
        let mut session = session(120, seed, &|q: &[f64], _: &[f64]| q.to_vec(), &still);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        session.poses.extend_from_within(..);
        let again = session.poses[120..].iter();
        let again: Vec<_> =
            again.map(|q| session.truth.point(q, 0, 0) + vector(&mut rng) * SIGMA).collect();
        session.points.extend(again);
        for row in [124, 139, 151, 166, 180, 197, 213, 231] {
            session.points[row] += vector(&mut rng).normalize() * 3e-3;
        }
        let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
        assert_eq!(outcome.verdict, Verdict::Explained, "{seed}: {:?}", outcome.unnamed);
        assert_eq!(names(&outcome), [("outliers", vec![])], "{seed}");
        assert_eq!(outcome.figures.outlier_rows.len(), 8, "{seed}");
    }
}
