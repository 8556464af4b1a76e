//! Sessions whose joints are elsewhere than they are read to be, or whose base moves.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, Outcome, diagnose};
use truearm_host::model::{Measurements, Robot};

use super::simulated::{Truth, UR10_LIKE, csv_of, robot, vector};

pub const SIGMA: f64 = 3e-5;

/// An arm of which nothing but geometry is known.
pub fn arm() -> Robot {
    let mut robot = robot(UR10_LIKE);
    robot.sigma = SIGMA;
    robot.links.clear();
    robot.gravity = None;
    robot
}

/// Points at random poses where the joints really are at `real` of what was read
/// and what was read before, seen after the base moved by `moved` of the row.
pub struct Session {
    pub truth: Truth,
    pub poses: Vec<Vec<f64>>,
    pub points: Vec<Vector3<f64>>,
}

/// Where the joints are at what is read, and what was read before.
pub type Real = dyn Fn(&[f64], &[f64]) -> Vec<f64>;

/// How poses are read: so many, each so many times, all of them in every round or each while the
/// arm stays.
#[derive(Debug, Clone, Copy)]
pub struct Readings {
    pub poses: usize,
    pub times: usize,
    pub in_rounds: bool,
}

impl Readings {
    pub fn once(poses: usize) -> Self {
        Self { poses, times: 1, in_rounds: false }
    }

    /// The pose of each row.
    pub fn rows(self) -> Vec<usize> {
        let rows = 0..self.poses * self.times;
        rows.map(|row| if self.in_rounds { row % self.poses } else { row / self.times }).collect()
    }
}

pub fn session(
    rows: usize,
    seed: u64,
    real: &Real,
    moved: &dyn Fn(usize) -> Vector3<f64>,
) -> Session {
    session_of(Readings::once(rows), seed, real, moved)
}

pub fn session_of(
    readings: Readings,
    seed: u64,
    real: &Real,
    moved: &dyn Fn(usize) -> Vector3<f64>,
) -> Session {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let truth = Truth::draw(&arm(), 1, 1, &mut rng);
    let pose = |rng: &mut ChaCha8Rng| {
        let degrees = |_| (rng.random_range(-140.0..140.0_f64) * 1e4).round() / 1e4;
        (0..6).map(degrees).map(f64::to_radians).collect::<Vec<f64>>()
    };
    let drawn: Vec<Vec<f64>> = (0..readings.poses).map(|_| pose(&mut rng)).collect();
    let poses: Vec<Vec<f64>> = readings.rows().iter().map(|k| drawn[*k].clone()).collect();
    let point = |k: usize| {
        let before = &poses[k.saturating_sub(1)];
        truth.point(&real(&poses[k], before), 0, 0) + moved(k) + vector(&mut rng) * SIGMA
    };
    let points = (0..poses.len()).map(point).collect();
    Session { truth, poses, points }
}

/// The file with columns beside it, one text a row and the header.
pub fn with(session: &Session, header: &str, cell: impl Fn(usize) -> String) -> String {
    let text = csv_of(&session.truth.robot, &session.poses, &session.points);
    let lines = text.lines().enumerate().map(|(k, line)| match (k, header) {
        (_, "") => format!("{line}\n"),
        (0, _) => format!("{line},{header}\n"),
        _ => format!("{line},{}\n", cell(k - 1)),
    });
    lines.collect()
}

pub fn diagnosed(robot: &Robot, text: &str) -> Outcome {
    let data = Measurements::parse("m.csv".as_ref(), text, robot).unwrap();
    diagnose(robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap().outcome
}

pub fn names(outcome: &Outcome) -> Vec<(&'static str, Vec<usize>)> {
    outcome.effects.iter().map(|e| (e.name, e.joints.clone())).collect()
}

pub fn still(_: usize) -> Vector3<f64> {
    Vector3::zeros()
}
