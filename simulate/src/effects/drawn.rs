//! Where an effect sits and how it is turned, at random.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;

use super::DefectKind;
use crate::body::{Body, Moment, loaded, loaded_across};
use crate::{Robot, vector};

/// A kind by its name, at a random place.
///
/// # Panics
/// With a name that is not one.
pub fn drawn(
    name: &str,
    robot: &Robot,
    body: &Body,
    poses: &[Moment],
    rng: &mut ChaCha8Rng,
) -> DefectKind {
    let revolute: Vec<usize> =
        (0..body.kinds.len()).filter(|j| body.kinds[*j] == JointKind::Revolute).collect();
    let joint = revolute[rng.random_range(0..revolute.len())];
    let phase = rng.random_range(0.0..std::f64::consts::TAU);
    match name {
        "joint-compliance" | "joint-stiffening" => {
            let loaded: Vec<usize> =
                revolute.into_iter().filter(|j| loaded(*j, robot, body, poses)).collect();
            spring(name, loaded[rng.random_range(0..loaded.len())])
        }
        // Under the first joint it would be the base.
        "lateral-compliance" => {
            let behind = revolute.into_iter().filter(|j| *j > 0);
            let loaded: Vec<usize> =
                behind.filter(|j| loaded_across(*j, robot, body, poses)).collect();
            DefectKind::LateralCompliance { joint: loaded[rng.random_range(0..loaded.len())] }
        }
        "base-compliance" => DefectKind::BaseCompliance { ratio: rng.random_range(0.5..2.0) },
        "encoder-eccentricity" => DefectKind::EncoderEccentricity { joint, phase },
        "gear-transmission-error" => {
            DefectKind::GearTransmissionError { joint, phases: [phase, phase * 3.7] }
        }
        "joint-gain" => DefectKind::JointGain { joint },
        "joint-coupling" => loop {
            let source = revolute[rng.random_range(0..revolute.len())];
            if source != joint {
                return DefectKind::JointCoupling { source, joint };
            }
        },
        "backlash" => {
            let largest = poses.iter().map(|m| body.torque(m, joint).abs()).fold(0.0_f64, f64::max);
            // Friction is made for the load; what an unloaded joint carries by
            // accident never overcomes it.
            let range = if loaded(joint, robot, body, poses) { 0.2..1.2 } else { 2.0..4.0 };
            DefectKind::Backlash { joint, friction: largest * rng.random_range(range) }
        }
        "readout-lag" => DefectKind::ReadoutLag { joint },
        "thermal-expansion" => DefectKind::ThermalExpansion,
        "tool-remount" => DefectKind::ToolRemount { direction: vector(rng).normalize() },
        "measurement-drift" => drift(rng),
        "joint-periodic-error" => {
            let ratio = robot.joints[joint].gear_ratio.unwrap_or(0.0);
            DefectKind::JointPeriodicError { joint, order: order(ratio, rng), phase }
        }
        "outliers" => DefectKind::Outliers,
        // Once a turn would be an axis out of square: geometry.
        "bearing wobble" => wobble(&revolute, phase, rng),
        "quadratic link bending" => bending(robot, rng),
        "memory of the last pose" => DefectKind::Memory { joint },
        other => panic!("{other} is no effect"),
    }
}

/// A tracker that moves and turns.
fn drift(rng: &mut ChaCha8Rng) -> DefectKind {
    let shift = vector(rng).normalize();
    DefectKind::MeasurementDrift { shift, turn: vector(rng).normalize() }
}

/// A joint's spring, linear or not.
fn spring(name: &str, joint: usize) -> DefectKind {
    match name {
        "joint-stiffening" => DefectKind::JointStiffening { joint },
        _ => DefectKind::JointCompliance { joint },
    }
}

/// Cycles a turn, whole or not, not where a gear that errs once an input turn
/// would be.
fn order(ratio: f64, rng: &mut ChaCha8Rng) -> f64 {
    loop {
        let order: f64 = rng.random_range(3.0..60.0);
        let order = if rng.random_bool(0.5) { order.round() } else { order };
        if (order - ratio).abs() > 2.0 {
            return order;
        }
    }
}

/// A link that bends; about the next joint's own axis it would be that joint's
/// stiffening.
fn bending(robot: &Robot, rng: &mut ChaCha8Rng) -> DefectKind {
    loop {
        let (joint, axis) = (rng.random_range(1..4), rng.random_range(0..2));
        if axis == 0 || robot.joints[joint + 1].link[0].sin().abs() < 0.5 {
            return DefectKind::LinkBending { joint, axis };
        }
    }
}

/// Not at the last axis: it moves a single marker as an eccentric encoder does,
/// and no data of one marker could tell them apart.
fn wobble(revolute: &[usize], phase: f64, rng: &mut ChaCha8Rng) -> DefectKind {
    let joint = revolute[rng.random_range(0..revolute.len() - 1)];
    DefectKind::BearingWobble { joint, order: f64::from(rng.random_range(2..=4)), phase }
}
