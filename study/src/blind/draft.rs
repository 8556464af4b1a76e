//! The arm behind a blind set, its session, and places and sizes for what is to be
//! hidden.

use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::{JointKind, Link, MdhParameters, Pose};
use truearm_host::identify::fit::{Freedom, fit};
use truearm_host::identify::{Problem, Scaling, State};
use truearm_host::model::Robot;
use truearm_simulate::arm::Arm;
use truearm_simulate::body::{Body, Moment};
use truearm_simulate::draw::moments;
use truearm_simulate::effects::{Defect, DefectKind, drawn};
use truearm_simulate::{csv, normal, rigid, robots, vector};

use super::secret::Secret;
use crate::simulated::{parse, rms, robot, stated};

/// Below this many noise floors an effect drowns: a place where it cannot be
/// more at any plausible size is no place to hide it.
pub const OBSERVABLE: f64 = 2.0;

/// The real arm behind a nominal one, and its errors in tolerances.
fn real(robot: &Robot, down: Vector3<f64>, rng: &mut ChaCha8Rng) -> (Arm, f64) {
    let scale = 0.5 * 6.0_f64.powf(rng.random_range(0.0..1.0));
    let errors = |p: [f64; 5], rng: &mut ChaCha8Rng| p.map(|x| x + normal(rng) * 1e-3 * scale);
    let links =
        robot.nominal().iter().map(|l| errors(l.parameters.to_array(), rng)).collect::<Vec<_>>();
    let turn = vector(rng) * 2.0;
    let station = rigid(&turn, &Vector3::from_fn(|_, _| rng.random_range(-3.0..3.0)));
    let lean = Rotation3::from_scaled_axis(vector(rng).normalize() * 0.05_f64.to_radians());
    let masses = robot.links.iter().map(|l| (l.mass * rng.random_range(0.92..1.08), l.com));
    let arm = Arm {
        body: Body {
            kinds: robot.joints.iter().map(|j| j.link.kind).collect(),
            links,
            gear_ratios: robot.joints.iter().map(|j| j.gear_ratio.unwrap_or(100.0)).collect(),
            masses: masses.collect(),
            gravity: lean * down,
            station,
            tool: robot.tool + vector(rng) * 2e-3,
        },
        defects: Vec::new(),
    };
    (arm, scale)
}

/// A set in the making.
pub struct Draft {
    pub robot: Robot,
    /// The real one; what is hidden is in it in the end.
    pub arm: Arm,
    sigma: f64,
    scale: f64,
    pub training: Vec<Moment>,
    pub holdout: Vec<Moment>,
}

impl Draft {
    /// A nominal arm's file, the real arm behind it, and a session.
    pub fn geometry(rng: &mut ChaCha8Rng) -> (String, Self) {
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

    /// Noise so many times as large as is stated.
    pub fn misstate(&mut self, times: f64) {
        self.sigma *= times;
    }

    /// Measures, and seals what was hidden: training, hold-out, secret.
    pub fn sealed(self, rng: &mut ChaCha8Rng) -> ([String; 2], Secret) {
        let (measurements, outliers) = self.measured(&self.training, rng, true);
        let (holdout, _) = self.measured(&self.holdout, rng, false);
        let mut torques = Vec::new();
        for defect in &self.arm.defects {
            if let DefectKind::Backlash { joint, .. } = defect.kind {
                torques.extend(self.training.iter().map(|m| self.arm.torque(m, joint)));
            }
        }
        let (truth, scale) = (self.truth(), self.scale);
        let secret = Secret { truth, arm: self.arm, scale, outliers, torques };
        ([measurements, holdout], secret)
    }

    /// Finds a place and a size for an effect. `None` if this arm has none.
    pub fn hide(&self, name: &str, [low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> Option<Defect> {
        for _ in 0..12 {
            let kind = drawn(name, &stated(&self.robot), &self.arm, &self.training, rng);
            if kind == DefectKind::Outliers {
                return Some(Defect { size: kind.largest(), kind });
            }
            if let Some(defect) = self.sized(kind, [low, high], rng) {
                return Some(defect);
            }
        }
        None
    }

    /// A size of a kind at its place that stands out as far as wanted.
    pub fn sized(
        &self,
        kind: DefectKind,
        [low, high]: [f64; 2],
        rng: &mut ChaCha8Rng,
    ) -> Option<Defect> {
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
            let mut data = parse(&self.robot, &file_of(&self.robot, moments, |_| Vector3::zeros()));
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
            instruments: Vec::new(),
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
        if gross && self.arm.defects.iter().any(|d| d.kind == DefectKind::Outliers) {
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
        (file_of(&self.robot, moments, |i| points[i]), wrong)
    }
}

/// The `measurements.csv` of a session.
pub fn file_of(robot: &Robot, moments: &[Moment], point: impl Fn(usize) -> Vector3<f64>) -> String {
    let prismatic = |j: usize| robot.joints[j].link.kind == JointKind::Prismatic;
    let joints = 0..robot.joints.len();
    let names = joints.clone().map(|j| {
        let unit = if prismatic(j) { "mm" } else { "deg" };
        format!("q{}_{unit}", j + 1)
    });
    let more = ["x_mm", "y_mm", "z_mm", "time_s", "temperature_c", "payload_kg", "series"];
    let directions = joints.map(|j| format!("dir{}", j + 1));
    let header: Vec<String> = names.chain(more.map(str::to_owned)).chain(directions).collect();
    let row = |(i, m): (usize, &Moment)| {
        let mut cells: Vec<String> = Vec::new();
        for (j, q) in m.q.iter().enumerate() {
            let value = if prismatic(j) { q * 1e3 } else { q.to_degrees() };
            cells.push(format!("{value:.5}"));
        }
        cells.extend(point(i).iter().map(|x| format!("{:.5}", x * 1e3)));
        cells.push(format!("{:.1}", m.time));
        cells.push(format!("{:.2}", m.temperature));
        cells.push(format!("{:.1}", m.payload));
        cells.push(if m.later { "B" } else { "A" }.to_owned());
        cells.extend(m.directions.iter().map(i8::to_string));
        cells
    };
    csv(std::iter::once(header).chain(moments.iter().enumerate().map(row)))
}
