//! Drawing of sessions.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;

use crate::body::Moment;
use crate::{Joint, Robot};

const HOLDOUT: usize = 40;

/// Poses of a session in the order of time, and others between them. Every
/// column varies in every set, so that none gives an effect away.
pub fn moments(robot: &Robot, rng: &mut ChaCha8Rng) -> [Vec<Moment>; 2] {
    let poses = rng.random_range(60..=120);
    let length = rng.random_range(1.5..4.0) * 3600.0;
    let change = length * rng.random_range(0.4..0.6);
    let cold = rng.random_range(17.0..22.0);
    let (rise, lag) = (rng.random_range(5.0..12.0), length * rng.random_range(0.2..0.6));
    let loads = [0.0, rng.random_range(1.0..4.0), rng.random_range(4.0..8.0)]
        .map(|x: f64| (x * 10.0).round() / 10.0);
    let at = |time: f64, q: Vec<f64>, before: Vec<f64>, rng: &mut ChaCha8Rng| {
        let time = (time * 10.0).round() / 10.0;
        let warm = cold + rise * (1.0 - (-time / lag).exp()) + 0.4 * (time / 700.0).sin();
        let warm = (warm * 100.0).round() / 100.0;
        Moment {
            directions: q.iter().map(|_| if rng.random_bool(0.5) { 1 } else { -1 }).collect(),
            q,
            before,
            time,
            temperature: warm,
            links: warm,
            // The load is changed every ten minutes.
            payload: loads[(time / 600.0) as usize % 3],
            later: time > change,
        }
    };
    let mut training: Vec<Moment> = Vec::new();
    let mut before = pose(robot, rng);
    for i in 0..poses {
        let time = length * (i as f64 + rng.random_range(0.0..0.8)) / f64::from(poses);
        let q = pose(robot, rng);
        training.push(at(time, q.clone(), before, rng));
        before = q;
    }
    let holdout = (0..HOLDOUT).map(|i| {
        let time = length * (i as f64 + rng.random_range(0.0..1.0)) / HOLDOUT as f64;
        let (q, before) = (pose(robot, rng), pose(robot, rng));
        at(time, q, before, rng)
    });
    let holdout = holdout.collect();
    [training, holdout]
}

/// Anywhere within limits, as a file writes it: what it says is what was.
pub(crate) fn pose(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let joint = |j: &Joint| {
        let [low, high] = j.limits.unwrap_or([-1.0, 1.0]);
        let q = rng.random_range(low..high);
        match j.kind {
            JointKind::Revolute => ((q.to_degrees() * 1e5).round() / 1e5).to_radians(),
            JointKind::Prismatic => (q * 1e8).round() / 1e8,
        }
    };
    robot.joints.iter().map(joint).collect()
}
