//! Blind sets: an arm, a session and what is hidden in it, drawn from a seed.
//! What was hidden stays sealed until [`BlindSet::open`].

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;
use truearm_host::effects;
use truearm_host::model::{Measurements, Robot};
use truearm_simulate::body::Moment;
use truearm_simulate::effects::DefectKind;
use truearm_simulate::{at_rest, vector};

use super::draft::{Draft, file_of};
use super::secret::Secret;
use crate::simulated::{parse, robot};

/// Something to hide: the name of a kind, and how far above the noise floor it
/// is to stand alone after a fit of geometry (drawn from a range).
pub type Wanted = (&'static str, [f64; 2]);

/// Names of the effects that reports can name.
pub const LISTED: [&str; effects::ALL.len()] = {
    let mut names = [""; effects::ALL.len()];
    let mut k = 0;
    while k < names.len() {
        names[k] = effects::ALL[k].name;
        k += 1;
    }
    names
};
/// And of some that no report can.
pub const UNLISTED: [&str; 3] =
    ["bearing wobble", "quadratic link bending", "memory of the last pose"];

/// What a user would have.
pub struct BlindSet {
    pub seed: u64,
    /// `robot.toml`
    pub robot: String,
    /// `measurements.csv`
    pub measurements: String,
    /// `holdout.csv`
    pub holdout: String,
    secret: Secret,
}

impl BlindSet {
    /// Draws a set; the seed alone decides everything but what is wanted.
    pub fn draw(seed: u64, wanted: &[Wanted]) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // An arm may have no place for an effect: then another one.
        loop {
            if let Some(set) = Self::attempt(seed, wanted, &mut rng) {
                return set;
            }
        }
    }

    /// What was hidden.
    pub fn open(&self) -> &Secret {
        &self.secret
    }

    /// Files as the program reads them.
    pub fn read(&self) -> (Robot, Measurements, Measurements) {
        let robot = robot(&self.robot);
        let data = parse(&robot, &self.measurements);
        let holdout = parse(&robot, &self.holdout);
        (robot, data, holdout)
    }

    fn attempt(seed: u64, wanted: &[Wanted], rng: &mut ChaCha8Rng) -> Option<Self> {
        let (text, mut draft) = Draft::geometry(rng);
        let mut defects = Vec::new();
        for (name, range) in wanted {
            defects.push(draft.hide(name, *range, rng)?);
        }
        draft.arm.defects = defects;
        Some(Self::of(seed, text, draft, rng))
    }

    fn of(seed: u64, robot: String, draft: Draft, rng: &mut ChaCha8Rng) -> Self {
        let ([measurements, holdout], secret) = draft.sealed(rng);
        Self { seed, robot, measurements, holdout, secret }
    }

    /// A set of which one joint was hardly moved: there a gain error and an
    /// eccentric encoder look alike, and one of the two is hidden.
    pub fn tie(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        loop {
            if let Some(set) = Self::attempt_tie(seed, &mut rng) {
                return set;
            }
        }
    }

    fn attempt_tie(seed: u64, rng: &mut ChaCha8Rng) -> Option<Self> {
        let (text, mut draft) = Draft::geometry(rng);
        let joint = rng.random_range(1..4);
        if draft.robot.joints[joint].link.kind != JointKind::Revolute {
            return None;
        }
        let [low, high] = draft.robot.joints[joint].limits?;
        let middle = low + (high - low) * rng.random_range(0.2..0.8);
        for moment in draft.training.iter_mut().chain(&mut draft.holdout) {
            let turned = middle + 0.15 * (moment.q[joint] - (low + high) / 2.0);
            moment.q[joint] = ((turned.to_degrees() * 1e5).round() / 1e5).to_radians();
        }
        let phase = rng.random_range(0.0..std::f64::consts::TAU);
        let kind = if rng.random_bool(0.5) {
            DefectKind::JointGain { joint }
        } else {
            DefectKind::EncoderEccentricity { joint, phase }
        };
        let defect = draft.sized(kind, [2.0, 5.0], rng)?;
        draft.arm.defects = vec![defect];
        Some(Self::of(seed, text, draft, rng))
    }

    /// The measurements with further poses (degrees or mm) behind them, on the
    /// same arm in the same session.
    pub fn measured_further(&self, poses: &[Vec<f64>]) -> String {
        let (robot, data, _) = self.read();
        let last = data.rows.last().and_then(|r| r.time).unwrap_or(0.0);
        let moment = |(i, pose): (usize, &Vec<f64>)| {
            let q = pose.iter().zip(&robot.joints).map(|(x, j)| match j.link.kind {
                JointKind::Revolute => x.to_radians(),
                JointKind::Prismatic => x * 1e-3,
            });
            let q: Vec<f64> = q.collect();
            Moment { time: last + 60.0 * (i + 1) as f64, later: true, ..at_rest(&q) }
        };
        let moments: Vec<Moment> = poses.iter().enumerate().map(moment).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(!self.seed);
        let arm = &self.secret.arm;
        let points: Vec<_> =
            moments.iter().map(|m| arm.point(m) + vector(&mut rng) * robot.sigma).collect();
        let more = file_of(&robot, &moments, |i| points[i]);
        let rows = more.split_once('\n').map_or("", |(_, rows)| rows);
        format!("{}{rows}", self.measurements)
    }
}
