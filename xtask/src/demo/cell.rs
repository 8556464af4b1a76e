//! The robot cell that the controller works in: a real arm, by the exact
//! constructions of the simulator, in front of a tracker. Nothing of its
//! kinematics is the crate's.

use std::fmt::{self, Display};

use nalgebra::{Matrix3x6, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::Pose;
use truearm_host::identify::{Options, identify};
use truearm_host::model::{Model, Robot};

use crate::run::Result;
use truearm_simulate::arm::Arm;
use truearm_simulate::body::Body;
use truearm_simulate::effects::{Defect, DefectKind};
use truearm_simulate::oracle::{self, Matrix};
use truearm_simulate::{at_rest, csv, rigid};
use truearm_study::simulated::{UR10_LIKE, normal, parse, robot, vector};

pub type Joints = [f64; 6];

/// Standard deviation of a coordinate that the tracker measures, m.
pub const NOISE: f64 = 2e-5;
/// Poses of the first calibration.
const POSES: usize = 52;

/// Least that the joints move the tool at a task, in any direction, m per rad: by
/// corrections within the compensator's bound of 0.03 rad, 9 mm.
const REACH: f64 = 0.3;
/// Of its difference quotients, rad.
const STEP: f32 = 1e-3;

/// What happens to the arm.
pub enum Event {
    /// Offsets of two joints, rad.
    Crash([(usize, f64); 2]),
    /// The base moved: rotation vector, rad, and translation, m, in its own frame.
    Loosened(Vector3<f64>, Vector3<f64>),
}

impl Event {
    /// What it moved, as the controller names it.
    pub fn groups(&self) -> String {
        match self {
            Self::Crash([(a, _), (b, _)]) => format!("joint-{} joint-{}", a + 1, b + 1),
            Self::Loosened(..) => "base".into(),
        }
    }
}

impl Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Crash([(a, x), (b, y)]) => {
                let [x, y] = [x * 1e3, y * 1e3];
                write!(f, "crash: joint {} by {x:+.2} mrad, joint {} by {y:+.2} mrad", a + 1, b + 1)
            }
            Self::Loosened(turn, shift) => {
                let [turn, shift] = [turn.norm() * 1e3, shift.norm() * 1e3];
                write!(f, "base loosened: by {shift:.2} mm, {turn:.2} mrad")
            }
        }
    }
}

/// Arm and tracker.
pub struct Cell {
    /// As the identification and the first blob have it.
    pub model: Model,
    arm: Arm,
    /// From the tracker's to the commanded frame, which stays where it is
    /// whatever happens to the arm.
    to_commanded: Pose<f64>,
    /// What the controller's own kinematics believes in.
    nominal: Arm,
    dice: ChaCha8Rng,
}

impl Cell {
    /// A new arm, calibrated.
    pub fn new(seed: u64) -> Result<Self> {
        let mut dice = ChaCha8Rng::seed_from_u64(seed);
        let robot = robot(UR10_LIKE);
        let mut arm = real(&robot, &mut dice);
        // What no parameter of the blob can say, a hundredth of a millimetre.
        let phase = dice.random_range(0.0..core::f64::consts::TAU);
        for kind in [
            DefectKind::BearingWobble { joint: 1, order: 3.0, phase },
            DefectKind::JointPeriodicError { joint: 2, order: 17.0, phase },
        ] {
            arm.defects.push(Defect { kind, size: 1e-5 });
        }
        let model = calibrate(&robot, &arm, &mut dice)?;
        let residual = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
        let to_commanded = residual.compose(&model.stations[0].1.inverse());
        let body = Body {
            links: robot.nominal().iter().map(|link| link.parameters.to_array()).collect(),
            station: oracle::identity(),
            tool: model.markers[0].1,
            ..arm.body.clone()
        };
        let nominal = Arm { body, defects: Vec::new() };
        Ok(Self { model, arm, to_commanded, nominal, dice })
    }

    /// A random task of the job, which keeps off the arm's singular poses and as
    /// far from them as corrections have to reach: elbow bent, all else free.
    pub fn task(&mut self) -> [f32; 6] {
        loop {
            let mut free = || self.dice.random_range(-2.6..2.6_f32);
            let [a, d, e, f] = [free(), free(), free(), free()];
            let (shoulder, elbow) = (-1.8..-0.6, 0.6..2.2);
            let shoulder = self.dice.random_range(shoulder);
            let command = [a, shoulder, self.dice.random_range(elbow), d, e, f];
            if self.reach(&command) > REACH {
                return command;
            }
        }
    }

    /// Smallest singular value of the tool point's Jacobian, m per rad: in every
    /// direction the joints move the tool at least so well.
    fn reach(&self, command: &[f32; 6]) -> f64 {
        let target = self.target(command);
        let jacobian = Matrix3x6::from_columns(&core::array::from_fn::<_, 6, _>(|k| {
            let mut moved = *command;
            moved[k] += STEP;
            (self.target(&moved) - target) / f64::from(moved[k] - command[k])
        }));
        jacobian.singular_values().min()
    }

    /// So many tasks.
    pub fn tasks(&mut self, count: usize) -> Vec<[f32; 6]> {
        (0..count).map(|_| self.task()).collect()
    }

    /// Where the tool is meant to be at a command, commanded frame, m.
    pub fn target(&self, command: &[f32; 6]) -> Vector3<f64> {
        self.nominal.point(&at_rest(&command.map(f64::from)))
    }

    /// Where it is at encoder readings.
    pub fn tool(&self, joints: &Joints) -> Vector3<f64> {
        self.to_commanded.transform_point(&self.arm.point(&at_rest(joints)))
    }

    /// An arm of the same build with these links, base and tool point.
    pub fn arm_with(&self, links: Vec<[f64; 5]>, base: Matrix<f64>, tool: Vector3<f64>) -> Arm {
        let body = Body { links, station: base, tool, ..self.nominal.body.clone() };
        Arm { body, ..self.nominal.clone() }
    }

    /// Where the tracker sees it.
    pub fn measured(&mut self, joints: &Joints) -> Vector3<f64> {
        self.tool(joints) + vector(&mut self.dice) * NOISE
    }

    /// A crash: any two joints, 1 to 5 mrad either way.
    pub fn crash(&mut self) -> Event {
        let first = self.dice.random_range(0..6);
        let second = (first + self.dice.random_range(1..6)) % 6;
        let mut slip = || {
            let size = self.dice.random_range(1e-3..5e-3);
            if self.dice.random_bool(0.5) { size } else { -size }
        };
        let slipped = [(first.min(second), slip()), (first.max(second), slip())];
        for (joint, by) in slipped {
            self.arm.links[joint][2] += by;
        }
        Event::Crash(slipped)
    }

    /// A loosened base: about 1 mm and 1 mrad.
    pub fn loosen(&mut self) -> Event {
        let turn = vector(&mut self.dice).normalize() * self.dice.random_range(0.5e-3..1.5e-3);
        let shift = vector(&mut self.dice).normalize() * self.dice.random_range(0.5e-3..1.5e-3);
        self.arm.station = oracle::product(&self.arm.station, &rigid(&turn, &shift));
        Event::Loosened(turn, shift)
    }
}

/// An arm made to the tolerances, its tracker anywhere.
fn real(robot: &Robot, dice: &mut ChaCha8Rng) -> Arm {
    let nominal = robot.nominal();
    let mut made = |p: [f64; 5]| p.map(|x| x + normal(dice) * 1e-3);
    let links = nominal.iter().map(|link| made(link.parameters.to_array())).collect();
    Arm {
        body: Body {
            kinds: nominal.iter().map(|link| link.kind).collect(),
            links,
            gear_ratios: vec![100.0; nominal.len()],
            masses: vec![(0.0, Vector3::zeros()); nominal.len()],
            gravity: Vector3::zeros(),
            station: rigid(&vector(dice), &(vector(dice) * 2.0)),
            tool: robot.tool + vector(dice) * 1e-3,
        },
        defects: Vec::new(),
    }
}

/// A first calibration: the tracker's file, identified.
fn calibrate(robot: &Robot, arm: &Arm, dice: &mut ChaCha8Rng) -> Result<Model> {
    let header = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm";
    let mut rows = vec![header.split(',').map(str::to_owned).collect::<Vec<_>>()];
    for _ in 0..POSES {
        // What the file says is what the joints were: rounded first.
        let degrees = [0; 6].map(|_| (dice.random_range(-150.0..150.0_f64) * 1e5).round() / 1e5);
        let point = arm.point(&at_rest(&degrees.map(f64::to_radians))) + vector(dice) * NOISE;
        let mut cells: Vec<String> = degrees.iter().map(|q| format!("{q:.5}")).collect();
        cells.extend(point.iter().map(|x| format!("{:.7}", x * 1e3)));
        rows.push(cells);
    }
    let data = parse(robot, &csv(&rows));
    Ok(identify(robot, &data, &Options::default(), &|_, _| ())?.model)
}
