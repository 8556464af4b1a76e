//! Blind sets: an arm, a session and what is hidden in it, drawn from a seed.
//! What was hidden stays sealed until [`BlindSet::open`].

use std::fmt::Write as _;

use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{JointKind, Link, MdhParameters, Pose};
use truearm_host::files::{Measurements, Robot};
use truearm_host::identify::fit::{Freedom, fit};
use truearm_host::identify::{Problem, Scaling, State};

use super::arm::{Arm, Moment};
use super::draw::{kind, moments};
use super::effects::{Defect, Kind};
use super::secret::Secret;
use super::{normal, oracle, parse, rms, robot, robots, vector};

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
        let [training, holdout] = moments(&robot, rng);
        let mut draft = Draft { robot, arm, sigma, scale, training, holdout };
        let mut defects = Vec::new();
        for (name, range) in wanted {
            defects.push(draft.hide(name, *range, rng)?);
        }
        draft.arm.defects = defects;
        let (measurements, outliers) = draft.measured(&draft.training, rng, true);
        let (holdout, _) = draft.measured(&draft.holdout, rng, false);
        let mut torques = Vec::new();
        for defect in &draft.arm.defects {
            if let Kind::Backlash { joint, .. } = defect.kind {
                torques.extend(draft.training.iter().map(|m| draft.arm.torque(m, joint)));
            }
        }
        let secret = Secret { truth: draft.truth(), arm: draft.arm, scale, outliers, torques };
        Some(Self { seed, robot: text, measurements, holdout, secret })
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
    /// Finds a place and a size for an effect. `None` if this arm has none.
    fn hide(&self, name: &str, [low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> Option<Defect> {
        for _ in 0..12 {
            let kind = kind(name, &self.robot, &self.arm, &self.training, rng);
            let mut size = kind.largest();
            if kind == Kind::Outliers {
                return Some(Defect { kind, size });
            }
            let of = |size: f64| self.above_floor(Defect { kind: kind.clone(), size });
            let mut reached = of(size);
            if reached < low.max(OBSERVABLE) {
                continue;
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
                row.point = arm.point(moment);
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
