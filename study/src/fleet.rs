//! Fleets of one type: what the prior learned from some arms is worth for the next.

use nalgebra::DVector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::MdhParameters;
use truearm_host::fleet::{Arm, Fleet};
use truearm_host::identify::{Identification, Options, identify};
use truearm_host::model::{Measurements, Robot};
use truearm_simulate::robots;

use crate::simulated::{Truth, normal, parse, rms, robot, state_of};

/// Noise of a coordinate, m: a laser tracker and what an arm repeats to.
pub const SIGMA: f64 = 5e-5;
/// Poses of every arm of a fleet, and of the next arm with what the fleet says.
pub const POSES: usize = 15;
/// Poses of the next arm without it.
pub const WITHOUT: [usize; 4] = [POSES, 20, 25, 30];
/// Poses at which an arm is judged, none of them fitted.
const JUDGED: usize = 100;
/// What a crash does to two parameters of a joint, in usual tolerances.
const CRASH: f64 = 10.0;

/// How far the parameters of arms of a type spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spreads {
    /// One usual tolerance each.
    Usual,
    /// 0.03 to 5 of them, each parameter its own.
    Unequal,
    /// Zeros that are set by hand, 1 to 5; what is machined, 0.02 to 0.2.
    Machined,
}

/// What is hard about a fleet.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub name: &'static str,
    pub spreads: Spreads,
    /// Arms that teach.
    pub arms: usize,
    /// Noise of a coordinate, m.
    pub sigma: f64,
    /// Stated sigma over the true one.
    pub stated: f64,
    /// Parameters that the drawing has wrong.
    pub drawing: usize,
    /// Whether an arm that teaches crashed.
    pub crashed: bool,
    /// Whether every arm that is judged crashed.
    pub next_crashed: bool,
}

impl Case {
    pub const fn of(name: &'static str, spreads: Spreads, arms: usize) -> Self {
        let (sigma, stated, drawing) = (SIGMA, 1.0, 0);
        let (crashed, next_crashed) = (false, false);
        Self { name, spreads, arms, sigma, stated, drawing, crashed, next_crashed }
    }
}

/// Tool error of one arm, RMS, m: with what the fleet says, and without it from so many
/// poses.
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    pub learned: f64,
    /// With the true spreads and means, which nobody knows.
    pub oracle: f64,
    pub without: [f64; WITHOUT.len()],
}

/// What came of one fleet.
pub struct Trial {
    pub errors: Vec<Errors>,
    /// Arms that were named although they do not differ, and whether the crashed was.
    pub wrongly_named: usize,
    pub crashed_named: bool,
    /// Corrections named as common that are not, and that are.
    pub wrongly_common: usize,
    pub rightly_common: usize,
}

/// A type of robot: what its arms have in common.
struct Type {
    robot: Robot,
    mean: DVector<f64>,
    spread: DVector<f64>,
}

impl Type {
    fn draw(case: &Case, rng: &mut ChaCha8Rng) -> Self {
        let mut robot = robot(robots::ALL[rng.random_range(0..robots::ALL.len())]);
        robot.sigma = case.sigma * case.stated;
        let size = 5 * robot.joints.len();
        let spread = DVector::from_fn(size, |k, _| {
            let u = rng.random_range(0.0..1.0);
            match case.spreads {
                Spreads::Usual => 1.0,
                Spreads::Unequal => 10_f64.powf(-1.5 + 2.2 * u),
                Spreads::Machined if k % 5 == 2 => 5_f64.powf(u),
                Spreads::Machined => 0.02 * 10_f64.powf(u),
            }
        });
        let mut mean = DVector::zeros(size);
        for _ in 0..case.drawing {
            let k = rng.random_range(0..size);
            mean[k] = if rng.random_bool(0.5) { 4.0 } else { -4.0 };
        }
        Self { robot, mean, spread }
    }

    /// With the true spreads and means.
    fn known(&self) -> Robot {
        let mut robot = self.robot.clone();
        for (i, joint) in robot.joints.iter_mut().enumerate() {
            joint.prior.tolerance = core::array::from_fn(|k| Some(self.spread[5 * i + k] * 1e-3));
            joint.prior.expected = core::array::from_fn(|k| self.mean[5 * i + k] * 1e-3);
        }
        robot
    }

    fn arm(&self, crashed: bool, rng: &mut ChaCha8Rng) -> Truth {
        let mut truth = Truth::draw_sized(&self.robot, 1, 1, 0.0, rng);
        let mut off =
            DVector::from_fn(self.mean.len(), |k, _| self.mean[k] + self.spread[k] * normal(rng));
        if crashed {
            let joint = rng.random_range(1..self.robot.joints.len());
            // The axis is bent and the zero has slipped.
            off[5 * joint] += CRASH;
            off[5 * joint + 2] -= CRASH;
        }
        for (i, link) in truth.links.iter_mut().enumerate() {
            let own = core::array::from_fn(|k| off[5 * i + k] * 1e-3);
            *link = link.corrected(&MdhParameters::from_array(own));
        }
        truth
    }
}

fn identified(robot: &Robot, data: &Measurements) -> Identification {
    identify(robot, data, &Options::default(), &|_, _| ()).unwrap()
}

/// Learns from a fleet of a fresh type and judges so many next arms.
pub fn trial(seed: u64, case: &Case, next: usize) -> Trial {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let of = Type::draw(case, &mut rng);
    let arms: Vec<Arm> = (0..case.arms)
        .map(|k| {
            let truth = of.arm(case.crashed && k == 0, &mut rng);
            let data = parse(&of.robot, &truth.measure(POSES, case.sigma, &mut rng));
            Arm::of(&identified(&of.robot, &data))
        })
        .collect();
    let fleet = Fleet::of(&arms);
    let taught = fleet.prior_of(&of.robot);
    let errors = (0..next).map(|_| judged(&of, &taught, case, &mut rng)).collect();
    let named = |k: &usize| fleet.arms[*k].apart;
    let right = fleet.common.iter().filter(|(k, _)| of.mean[*k] != 0.0).count();
    Trial {
        errors,
        wrongly_named: (usize::from(case.crashed)..case.arms).filter(named).count(),
        crashed_named: case.crashed && named(&0),
        wrongly_common: fleet.common.len() - right,
        rightly_common: right,
    }
}

fn judged(of: &Type, taught: &Robot, case: &Case, rng: &mut ChaCha8Rng) -> Errors {
    let truth = of.arm(case.next_crashed, rng);
    let most = WITHOUT[WITHOUT.len() - 1];
    let text = truth.measure(most, case.sigma, rng);
    let check = parse(&of.robot, &truth.measure(JUDGED, 0.0, rng));
    let error = |robot: &Robot, poses: usize| {
        let lines: Vec<&str> = text.lines().take(1 + poses).collect();
        let found = identified(robot, &parse(robot, &lines.join("\n")));
        rms(robot, &state_of(&found, &check), &check)
    };
    Errors {
        learned: error(taught, POSES),
        oracle: error(&of.known(), POSES),
        without: WITHOUT.map(|poses| error(&of.robot, poses)),
    }
}
