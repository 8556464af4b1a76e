//! What the host makes of the same touches: kinematics of 4x4 matrices in `f64`, nothing
//! of the crate but the blob it begins with.

use nalgebra::{DVector, Vector3};
use truearm::ArmParameters;
use truearm_simulate::rigid;
use truearm_study::simulated::{Truth, UR10_LIKE, robot};

use super::cell::Face;
use super::format::{Accident, JOINTS, RADIUS, SIGMA};
use crate::least_squares::least_squares;

/// Joints whose offsets may have slipped: those of `format::CHOSEN`.
const SLIPPING: [usize; 4] = [1, 2, 3, 4];
/// How far each may have, rad: the usual prior of an offset.
const PRIOR: f64 = 0.02;

/// The arm after the accident.
pub fn mended(stored: &ArmParameters<f64, JOINTS>, accident: &Accident) -> Truth {
    let arm = as_stored(stored);
    let about = accident.about.point().map(f64::from);
    let plate = |x: &[f64]| {
        let normal = Vector3::new(x[0], x[1], 1.0).normalize();
        Face { point: about + normal * x[2], normal }
    };
    // All touches in one solve, before and after.
    let found = least_squares(3 + SLIPPING.len(), |x| {
        let (place, slip) = x.split_at(3);
        let before = rests(&arm, &plate(place), &accident.before);
        let after = rests(&slipped(&arm, slip), &plate(place), &accident.after);
        let prior = slip.iter().map(|x| -x / PRIOR);
        let all = before.iter().chain(&after).copied().chain(prior).collect();
        DVector::from_vec(all)
    });
    slipped(&arm, &found.as_slice()[3..])
}

/// Heights at which the ball touched, less those of the model, in standard deviations.
fn rests(arm: &Truth, plate: &Face, touches: &[[f32; JOINTS]]) -> DVector<f64> {
    let rests = touches.iter().map(|q| {
        let height = plate.height(&arm.point(&q.map(f64::from), 0, 0));
        (f64::from(RADIUS) - height) / f64::from(SIGMA)
    });
    DVector::from_iterator(touches.len(), rests)
}

/// The stored arm, which stands where the commanded frame has it.
fn as_stored(stored: &ArmParameters<f64, JOINTS>) -> Truth {
    let links = stored.nominal.iter().zip(&stored.corrections);
    Truth {
        robot: robot(UR10_LIKE),
        links: links.map(|(link, correction)| link.corrected(correction)).collect(),
        bases: vec![rigid(&stored.base_rotation, &stored.base_translation)],
        tools: vec![stored.tool],
    }
}

/// With offsets of the joints that may have slipped, rad.
fn slipped(arm: &Truth, by: &[f64]) -> Truth {
    let mut links = arm.links.clone();
    for (joint, by) in SLIPPING.iter().zip(by) {
        links[*joint].parameters.theta += by;
    }
    Truth { robot: arm.robot.clone(), links, bases: arm.bases.clone(), tools: arm.tools.clone() }
}
