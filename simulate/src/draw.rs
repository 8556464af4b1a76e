//! Drawing of sessions and of places for effects.

use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;

use crate::arm::{Arm, Moment};
use crate::effects::Kind;
use crate::{Joint, Robot, vector};

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
        Moment {
            directions: q.iter().map(|_| if rng.random_bool(0.5) { 1 } else { -1 }).collect(),
            q,
            before,
            time,
            temperature: (warm * 100.0).round() / 100.0,
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
fn pose(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<f64> {
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

/// Whether gravity loads a joint by design. What a vertical axis carries
/// because floor and axes lean a little no robot file can tell, and a spring
/// there would be in the measurements but not in any model.
fn loaded(joint: usize, robot: &Robot, arm: &Arm, poses: &[Moment]) -> bool {
    let stated = Arm {
        links: robot.joints.iter().map(|j| j.link).collect(),
        masses: robot.masses.clone(),
        gravity: robot.gravity.unwrap_or_default(),
        tool: robot.tool,
        ..arm.clone()
    };
    let (mut all, mut unknown) = (0.0, 0.0);
    for moment in poses {
        let torque = arm.torque(moment, joint);
        all += torque.powi(2);
        unknown += (torque - stated.torque(moment, joint)).powi(2);
    }
    unknown < 0.2_f64.powi(2) * all
}

/// A kind by its name, at a random place.
///
/// # Panics
/// With a name that is not one.
pub fn kind(name: &str, robot: &Robot, arm: &Arm, poses: &[Moment], rng: &mut ChaCha8Rng) -> Kind {
    let revolute: Vec<usize> =
        (0..arm.kinds.len()).filter(|j| arm.kinds[*j] == JointKind::Revolute).collect();
    let joint = revolute[rng.random_range(0..revolute.len())];
    let phase = rng.random_range(0.0..std::f64::consts::TAU);
    match name {
        "joint-compliance" => {
            let loaded: Vec<usize> =
                revolute.into_iter().filter(|j| loaded(*j, robot, arm, poses)).collect();
            Kind::JointCompliance { joint: loaded[rng.random_range(0..loaded.len())] }
        }
        "base-compliance" => Kind::BaseCompliance { ratio: rng.random_range(0.5..2.0) },
        "encoder-eccentricity" => Kind::EncoderEccentricity { joint, phase },
        "gear-transmission-error" => {
            Kind::GearTransmissionError { joint, phases: [phase, phase * 3.7] }
        }
        "joint-gain" => Kind::JointGain { joint },
        "joint-coupling" => loop {
            let source = revolute[rng.random_range(0..revolute.len())];
            if source != joint {
                return Kind::JointCoupling { source, joint };
            }
        },
        "backlash" => {
            let largest = poses.iter().map(|m| arm.torque(m, joint).abs()).fold(0.0_f64, f64::max);
            // Friction is made for the load; what an unloaded joint carries by
            // accident never overcomes it.
            let range = if loaded(joint, robot, arm, poses) { 0.2..1.2 } else { 2.0..4.0 };
            Kind::Backlash { joint, friction: largest * rng.random_range(range) }
        }
        "thermal-expansion" => Kind::ThermalExpansion,
        "tool-remount" => Kind::ToolRemount { direction: vector(rng).normalize() },
        "measurement-drift" => Kind::MeasurementDrift {
            shift: vector(rng).normalize(),
            turn: Vector3::normalize(&vector(rng)),
        },
        "joint-periodic-error" => {
            // Not where a gear that errs once an input turn would be.
            let ratio = robot.joints[joint].gear_ratio.unwrap_or(0.0);
            loop {
                let order: f64 = rng.random_range(3.0..60.0);
                let order = if rng.random_bool(0.5) { order.round() } else { order };
                if (order - ratio).abs() > 2.0 {
                    return Kind::JointPeriodicError { joint, order, phase };
                }
            }
        }
        "outliers" => Kind::Outliers,
        // Once a turn would be an axis out of square: geometry.
        "bearing wobble" => {
            // The last axis moves a single marker as an eccentric encoder does:
            // no data of one marker could tell them apart.
            let inner = &revolute[..revolute.len() - 1];
            let joint = inner[rng.random_range(0..inner.len())];
            Kind::BearingWobble { joint, order: f64::from(rng.random_range(2..=4)), phase }
        }
        "quadratic link bending" => {
            Kind::LinkBending { joint: rng.random_range(1..4), axis: rng.random_range(0..2) }
        }
        "memory of the last pose" => Kind::Memory { joint },
        other => panic!("{other} is no effect"),
    }
}
