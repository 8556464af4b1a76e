//! Blind sets: an arm, a session and what is hidden in it, drawn from a seed.
//! What was hidden stays sealed until [`BlindSet::open`].

use std::fmt::Write as _;

use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{JointKind, Link, MdhParameters, Pose};
use truearm_host::identify::fit::{Freedom, fit};
use truearm_host::identify::{Problem, Scaling, State};
use truearm_host::model::{Measurements, Robot};
use truearm_simulate::arm::{Arm, Moment};
use truearm_simulate::draw::{kind, moments};
use truearm_simulate::effects::{Defect, Kind};
use truearm_simulate::{normal, oracle, robots, vector};

use super::secret::Secret;
use crate::simulated::{parse, rms, robot, stated};

/// Something to hide: the name of a kind, and how far above the noise floor it
/// is to stand alone after a fit of geometry (drawn from a range).
pub type Wanted = (&'static str, [f64; 2]);

/// Names of the effects that reports can name.
pub const LISTED: [&str; 12] = [
    "joint-compliance",
    "base-compliance",
    "encoder-eccentricity",
    "gear-transmission-error",
    "joint-gain",
    "joint-coupling",
    "backlash",
    "thermal-expansion",
    "tool-remount",
    "measurement-drift",
    "joint-periodic-error",
    "outliers",
];
/// And of some that no report can.
pub const UNLISTED: [&str; 3] =
    ["bearing wobble", "quadratic link bending", "memory of the last pose"];

/// Below this many noise floors an effect drowns: a place where it cannot be
/// more at any plausible size is no place to hide it.
pub const OBSERVABLE: f64 = 2.0;

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
        Some(draft.sealed(seed, text, rng))
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
            Kind::JointGain { joint }
        } else {
            Kind::EncoderEccentricity { joint, phase }
        };
        let defect = draft.sized(kind, [2.0, 5.0], rng)?;
        draft.arm.defects = vec![defect];
        Some(draft.sealed(seed, text, rng))
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
            Moment {
                directions: vec![1; q.len()],
                before: q.clone(),
                q,
                time: last + 60.0 * (i + 1) as f64,
                temperature: 20.0,
                payload: 0.0,
                later: true,
            }
        };
        let moments: Vec<Moment> = poses.iter().enumerate().map(moment).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(!self.seed);
        let arm = &self.secret.arm;
        let points: Vec<_> =
            moments.iter().map(|m| arm.point(m) + vector(&mut rng) * robot.sigma).collect();
        let more = csv(&robot, &moments, |i| points[i]);
        let rows = more.split_once('\n').map_or("", |(_, rows)| rows);
        format!("{}{rows}", self.measurements)
    }
}

/// The real arm behind a nominal one, and its errors in tolerances.
fn real(robot: &Robot, down: Vector3<f64>, rng: &mut ChaCha8Rng) -> (Arm, f64) {
    let scale = 0.5 * 6.0_f64.powf(rng.random_range(0.0..1.0));
    let errors = |p: [f64; 5], rng: &mut ChaCha8Rng| p.map(|x| x + normal(rng) * 1e-3 * scale);
    let links =
        robot.nominal().iter().map(|l| errors(l.parameters.to_array(), rng)).collect::<Vec<_>>();
    let turn = Rotation3::from_scaled_axis(vector(rng) * 2.0);
    let mut station = oracle::identity();
    for i in 0..3 {
        (0..3).for_each(|j| station[i][j] = turn[(i, j)]);
        station[i][3] = rng.random_range(-3.0..3.0);
    }
    let lean = Rotation3::from_scaled_axis(vector(rng).normalize() * 0.05_f64.to_radians());
    let masses = robot.links.iter().map(|l| (l.mass * rng.random_range(0.92..1.08), l.com));
    let arm = Arm {
        kinds: robot.joints.iter().map(|j| j.link.kind).collect(),
        links,
        gear_ratios: robot.joints.iter().map(|j| j.gear_ratio.unwrap_or(100.0)).collect(),
        masses: masses.collect(),
        gravity: lean * down,
        station,
        tool: robot.tool + vector(rng) * 2e-3,
        defects: Vec::new(),
    };
    (arm, scale)
}

/// A set in the making.
struct Draft {
    robot: Robot,
    arm: Arm,
    sigma: f64,
    scale: f64,
    training: Vec<Moment>,
    holdout: Vec<Moment>,
}

impl Draft {
    /// A nominal arm's file, the real arm behind it, and a session.
    fn geometry(rng: &mut ChaCha8Rng) -> (String, Self) {
        let text = robots::ALL[rng.random_range(0..robots::ALL.len())];
        let sigma = f64::from(rng.random_range(10..=30)) * 1e-6;
        // On the floor, under a ceiling, at a wall.
        let down = match rng.random_range(0..4) {
            0 => Vector3::new(0.0, 0.0, 9.81),
            1 => Vector3::new(9.81, 0.0, 0.0),
            _ => Vector3::new(0.0, 0.0, -9.81),
        };
        let text = format!(
            "measurement_sigma_mm = {:.3}\ngravity_m_s2 = {:?}\n{text}",
            sigma * 1e3,
            down.data.0[0]
        );
        let robot = robot(&text);
        let (arm, scale) = real(&robot, down, rng);
        let [training, holdout] = moments(&stated(&robot), rng);
        (text, Draft { robot, arm, sigma, scale, training, holdout })
    }

    /// Measures, and seals what was hidden.
    fn sealed(self, seed: u64, text: String, rng: &mut ChaCha8Rng) -> BlindSet {
        let (measurements, outliers) = self.measured(&self.training, rng, true);
        let (holdout, _) = self.measured(&self.holdout, rng, false);
        let mut torques = Vec::new();
        for defect in &self.arm.defects {
            if let Kind::Backlash { joint, .. } = defect.kind {
                torques.extend(self.training.iter().map(|m| self.arm.torque(m, joint)));
            }
        }
        let (truth, scale) = (self.truth(), self.scale);
        let secret = Secret { truth, arm: self.arm, scale, outliers, torques };
        BlindSet { seed, robot: text, measurements, holdout, secret }
    }

    /// Finds a place and a size for an effect. `None` if this arm has none.
    fn hide(&self, name: &str, [low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> Option<Defect> {
        for _ in 0..12 {
            let kind = kind(name, &stated(&self.robot), &self.arm, &self.training, rng);
            if kind == Kind::Outliers {
                return Some(Defect { size: kind.largest(), kind });
            }
            if let Some(defect) = self.sized(kind, [low, high], rng) {
                return Some(defect);
            }
        }
        None
    }

    /// A size of a kind at its place that stands out as far as wanted.
    fn sized(&self, kind: Kind, [low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> Option<Defect> {
        let mut size = kind.largest();
        let of = |size: f64| self.above_floor(Defect { kind: kind.clone(), size });
        let mut reached = of(size);
        if reached < low.max(OBSERVABLE) {
            return None;
        }
        let target = low + rng.random_range(0.0..=1.0) * (high.min(reached) - low);
        // Nearly proportional: a few proportional steps do what bisection would.
        for _ in 0..6 {
            if (reached / target - 1.0).abs() < 0.02 {
                return Some(Defect { kind, size });
            }
            size *= target / reached;
            reached = of(size);
        }
        None
    }

    /// RMS that geometry alone leaves of a defect alone, on noise-free poses it
    /// was not fitted to, in noise floors.
    fn above_floor(&self, defect: Defect) -> f64 {
        let arm = Arm { defects: vec![defect], ..self.arm.clone() };
        let seen = |moments: &[Moment]| {
            let mut data = parse(&self.robot, &csv(&self.robot, moments, |_| Vector3::zeros()));
            for (row, moment) in data.rows.iter_mut().zip(moments) {
                row.measured = arm.point(moment).into();
            }
            data
        };
        let (data, check) = (seen(&self.training), seen(&self.holdout));
        let problem = Problem::new(&data, &self.robot, Scaling::Prior);
        let rows: Vec<usize> = (0..data.rows.len()).collect();
        let freedom = Freedom::All(self.scale.powi(-2));
        match fit(&problem, &rows, None, &self.truth(), freedom) {
            Ok(found) => rms(&self.robot, &found.state, &check) / (3.0_f64.sqrt() * self.sigma),
            Err(_) => 0.0,
        }
    }

    /// The true geometry.
    fn truth(&self) -> State {
        let station = &self.arm.station;
        let link = |(kind, p): (&JointKind, &[f64; 5])| Link {
            kind: *kind,
            parameters: MdhParameters::from_array(*p),
        };
        State {
            bases: vec![Pose {
                rotation: Matrix3::from_fn(|i, j| station[i][j]),
                translation: Vector3::from_fn(|i, _| station[i][3]),
            }],
            markers: vec![self.arm.tool],
            links: self.arm.kinds.iter().zip(&self.arm.links).map(link).collect(),
            terms: Vec::new(),
        }
    }

    /// The file of a session, and which rows (from 1) have gross errors.
    fn measured(
        &self,
        moments: &[Moment],
        rng: &mut ChaCha8Rng,
        gross: bool,
    ) -> (String, Vec<usize>) {
        let mut points: Vec<Vector3<f64>> =
            moments.iter().map(|m| self.arm.point(m) + vector(rng) * self.sigma).collect();
        let mut wrong = Vec::new();
        if gross && self.arm.defects.iter().any(|d| d.kind == Kind::Outliers) {
            let count = (0.03 * moments.len() as f64).round() as usize;
            while wrong.len() < count {
                let row = rng.random_range(0..moments.len());
                if !wrong.contains(&(row + 1)) {
                    wrong.push(row + 1);
                    let size = 0.3e-3 * 10.0_f64.powf(rng.random_range(0.0..1.0));
                    points[row] += vector(rng).normalize() * size;
                }
            }
            wrong.sort_unstable();
        }
        (csv(&self.robot, moments, |i| points[i]), wrong)
    }
}

/// A `measurements.csv`.
fn csv(robot: &Robot, moments: &[Moment], point: impl Fn(usize) -> Vector3<f64>) -> String {
    let prismatic = |j: usize| robot.joints[j].link.kind == JointKind::Prismatic;
    let n = robot.joints.len();
    let mut text = String::new();
    for j in 0..n {
        let _ = write!(text, "q{}_{},", j + 1, if prismatic(j) { "mm" } else { "deg" });
    }
    text += "x_mm,y_mm,z_mm,time_s,temperature_c,payload_kg,series";
    (1..=n).for_each(|j| text += &format!(",dir{j}"));
    text.push('\n');
    for (i, m) in moments.iter().enumerate() {
        for (j, q) in m.q.iter().enumerate() {
            let value = if prismatic(j) { q * 1e3 } else { q.to_degrees() };
            let _ = write!(text, "{value:.5},");
        }
        point(i).iter().for_each(|x| text += &format!("{:.5},", x * 1e3));
        let series = if m.later { "B" } else { "A" };
        let _ = write!(text, "{:.1},{:.2},{:.1},{series}", m.time, m.temperature, m.payload);
        m.directions.iter().for_each(|d| text += &format!(",{d}"));
        text.push('\n');
    }
    text
}
