//! The paper-like cell: arm, poses, and errors tuned to the paper's figures.

use std::path::Path;

use nalgebra::{Rotation3, Vector3};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::Pose;

use super::arm::{Arm, JointDefect, draw_errors};
use super::paper;
use crate::simulated::{csv_of, measured, vector};
use truearm_host::error::Result;
use truearm_host::evaluate::residuals;
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Conditions, Problem, Scaling, State, nominal_state};
use truearm_host::methods::{Frames, Method, Rpim, Task};
use truearm_host::model::arm::{RowInputs, chain};
use truearm_host::model::{Measurements, Robot};

/// The nominal arm's file.
pub const ROBOT: &str = include_str!("robot.toml");

/// Poses of section V, of section VI to identify and to validate, and noise-free
/// ones that show what no paper can: the error of the model alone.
pub const COUNTS: [usize; 4] = [9, 52, 18, 250];

/// What the arm does beyond geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Nothing: the model can represent every error.
    Geometric,
    /// Springs and gears that leave the best geometric fit the paper's MAE.
    Beyond,
}

/// A drawn cell and what its tracker saw.
pub struct Cell {
    /// The arm and its truth.
    pub arm: Arm,
    /// Nine poses of the paper's simulation.
    pub nine: Measurements,
    /// 52 poses to identify.
    pub identification: Measurements,
    /// 18 poses to validate.
    pub validation: Measurements,
    /// Noise-free.
    pub exact: Measurements,
    /// The text of these files.
    pub files: Vec<(&'static str, String)>,
}

/// Sides of the 800 mm cube: y and z as far as the paper's text gives ranges.
const CUBE: [[f64; 2]; 3] = [[-0.4, 0.4], [-0.2, 0.6], [0.0, 0.8]];

/// Joint values whose target lies in the cube, spread over a grid of it.
fn poses(robot: &Robot, count: usize, rng: &mut impl Rng) -> Vec<Vec<f64>> {
    let arm = chain(&robot.nominal(), Pose::identity(), robot.tool);
    let cells = (1..).find(|n| n * n * n >= count).unwrap_or(1);
    let mut taken = vec![false; cells * cells * cells];
    let mut out: Vec<Vec<f64>> = Vec::new();
    for attempt in 0.. {
        if out.len() == count {
            break;
        }
        let joint = |j: &truearm_host::model::Joint| {
            let [low, high] = j.limits.unwrap_or([-3.0, 3.0]);
            // What the file says is what the encoders read.
            (rng.random_range(low..high).to_degrees() * 1e4).round() / 1e4
        };
        let degrees: Vec<f64> = robot.joints.iter().map(joint).collect();
        let q: Vec<f64> = degrees.iter().map(|d| d.to_radians()).collect();
        let p = arm.bent(&q, &[], &RowInputs::default()).translation;
        let share = |k: usize| (p[k] - CUBE[k][0]) / (CUBE[k][1] - CUBE[k][0]);
        if !(0..3).all(|k| (0.0..1.0).contains(&share(k))) {
            continue;
        }
        let cell = (0..3).fold(0, |at, k| at * cells + (share(k) * cells as f64) as usize);
        // Corners are out of reach; what is left is then filled twice.
        if !taken[cell] || attempt > 20_000 {
            taken[cell] = true;
            out.push(q);
        }
    }
    out
}

impl Cell {
    /// Drawn from a seed.
    ///
    /// # Errors
    /// When a simulated arm cannot be identified.
    pub fn draw(seed: u64, kind: Kind) -> Result<Self> {
        let robot = Robot::parse(Path::new("robot.toml"), ROBOT)?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let sets = COUNTS.map(|count| poses(&robot, count, &mut rng));
        let errors = draw_errors(robot.joints.len(), &mut rng);
        let noise = sets
            .each_ref()
            .map(|set| set.iter().map(|_| vector(&mut rng) * robot.sigma).collect::<Vec<_>>());
        let turn = Vector3::new(0.0, 0.0, rng.random_range(-3.0..3.0));
        let tilt = vector(&mut rng) * 0.02;
        let base = Pose {
            rotation: (Rotation3::from_scaled_axis(tilt) * Rotation3::from_scaled_axis(turn))
                .into_inner(),
            translation: Vector3::new(
                rng.random_range(2.0..3.0),
                rng.random_range(-1.0..1.0),
                rng.random_range(-0.8..-0.4),
            ),
        };
        let defects: Vec<JointDefect> = (0..robot.joints.len())
            .map(|j| {
                let size = rng.random_range(0.7..1.3);
                let phase = rng.random_range(0.0..std::f64::consts::TAU);
                // Springs in shoulder and elbow, waves in waist and shoulder.
                let compliance = if matches!(j, 1 | 2) { 2e-5 * size } else { 0.0 };
                let gear = if matches!(j, 0 | 1) { 5e-4 * size } else { 0.0 };
                JointDefect { compliance, gear, phase }
            })
            .collect();
        let draw = Draw { robot, sets, noise, base, errors, defects };
        let (mut scale, mut beyond) = (1.5, f64::from(u8::from(kind == Kind::Beyond)));
        // Errors are nearly proportional to what causes them.
        for _ in 0..12 {
            let (nominal, fitted) = draw.mean_errors(scale, beyond)?;
            let wrong = (nominal / paper::NC.mean_mm - 1.0).abs()
                + beyond.min(1.0) * (fitted / paper::RPIM.mean_mm - 1.0).abs();
            if wrong < 1e-3 {
                break;
            }
            scale *= (paper::NC.mean_mm / nominal).clamp(0.3, 3.0);
            beyond *= (paper::RPIM.mean_mm / fitted).clamp(0.3, 3.0);
        }
        draw.cell(scale, beyond)
    }
}

impl Cell {
    /// Measured poses whose joints are within 20 degrees of one pose, and
    /// noise-free ones of that region.
    ///
    /// # Errors
    /// None that a cell which could be drawn does not have.
    pub fn narrow(&self, count: usize, rng: &mut impl Rng) -> Result<(Measurements, Measurements)> {
        let centre = &self.identification.rows[0].q;
        let mut poses = |count: usize| -> Vec<Vec<f64>> {
            let mut near = |q: &f64| {
                let degrees = q.to_degrees() + rng.random_range(-20.0..20.0);
                ((degrees * 1e4).round() / 1e4).to_radians()
            };
            (0..count).map(|_| centre.iter().map(&mut near).collect()).collect()
        };
        let (fitted, judged) = (poses(count), poses(COUNTS[3]));
        let sigma = self.arm.robot.sigma;
        let noise: Vec<_> = fitted.iter().map(|_| vector(rng) * sigma).collect();
        let silent = vec![Vector3::zeros(); judged.len()];
        let seen = |name, poses: &[_], noise: &[_]| {
            measured(&self.arm.robot, name, poses, &self.arm.seen(poses, noise))
        };
        Ok((seen("narrow", &fitted, &noise)?, seen("narrow-exact", &judged, &silent)?))
    }
}

/// All random numbers of a cell; how large the errors are is open.
struct Draw {
    robot: Robot,
    sets: [Vec<Vec<f64>>; 4],
    noise: [Vec<Vector3<f64>>; 4],
    base: Pose<f64>,
    errors: Vec<f64>,
    defects: Vec<JointDefect>,
}

impl Draw {
    fn arm(&self, scale: f64, beyond: f64) -> Arm {
        let mut arm = Arm::new(&self.robot, self.base, &self.errors, scale);
        let grown = |d: &JointDefect| JointDefect {
            compliance: d.compliance * beyond,
            gear: d.gear * beyond,
            phase: d.phase,
        };
        arm.defects = self.defects.iter().map(grown).collect();
        arm
    }

    fn seen(&self, arm: &Arm, set: usize, name: &str) -> Result<Measurements> {
        measured(&self.robot, name, &self.sets[set], &arm.seen(&self.sets[set], &self.noise[set]))
    }

    /// Mean error over identification and validation poses, mm: nominal arm
    /// registered, and best geometric fit.
    fn mean_errors(&self, scale: f64, beyond: f64) -> Result<(f64, f64)> {
        let arm = self.arm(scale, beyond);
        let (data, check) = (self.seen(&arm, 1, "52")?, self.seen(&arm, 2, "18")?);
        let problem = Problem::new(&data, &self.robot, Scaling::Prior);
        let rows: Vec<usize> = (0..data.rows.len()).collect();
        let first = register(&data, &problem.nominal, self.robot.tool)?;
        let nominal = nominal_state(&problem, &rows, &first)?;
        let task = Task::new(&problem, nominal.clone(), &rows, Frames::Fitted);
        let fitted = Rpim.solve(&task)?.state;
        let mean = |state: &State| {
            let of = |d: &Measurements| residuals(d, &Conditions::new(d, &self.robot), state);
            let all = [of(&data), of(&check)].concat();
            all.iter().map(|r| r.norm() * 1e3).sum::<f64>() / all.len() as f64
        };
        Ok((mean(&nominal), mean(&fitted)))
    }

    fn cell(self, scale: f64, beyond: f64) -> Result<Cell> {
        let arm = self.arm(scale, beyond);
        let silent = vec![Vector3::zeros(); self.sets[3].len()];
        let exact = arm.seen(&self.sets[3], &silent);
        let names = ["nine-poses.csv", "identification.csv", "validation.csv"];
        let file = |k: usize| {
            let points = arm.seen(&self.sets[k], &self.noise[k]);
            (names[k], csv_of(&self.robot, &self.sets[k], &points))
        };
        Ok(Cell {
            nine: self.seen(&arm, 0, names[0])?,
            identification: self.seen(&arm, 1, names[1])?,
            validation: self.seen(&arm, 2, names[2])?,
            exact: measured(&self.robot, "exact", &self.sets[3], &exact)?,
            files: vec![file(0), file(1), file(2), ("robot.toml", ROBOT.to_owned())],
            arm,
        })
    }
}
