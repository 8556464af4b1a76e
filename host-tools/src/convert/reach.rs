//! Where an identified arm is looked at, to say how large a difference is.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;

use super::Identified;
use crate::model::Model;
use crate::model::arm::chain;

/// Poses drawn to say how large something is.
pub(super) const POSES: usize = 500;

/// The covered range of each joint; its limits where nothing is known of that,
/// else a turn or two metres; rad or m.
pub(super) fn ranges(model: &Model) -> Vec<[f64; 2]> {
    let joints = model.robot.joints.iter().zip(&model.covered);
    let range = joints.map(|(joint, covered)| {
        covered.or(joint.limits).unwrap_or(match joint.link.kind {
            JointKind::Revolute => [-std::f64::consts::PI, std::f64::consts::PI],
            JointKind::Prismatic => [-1.0, 1.0],
        })
    });
    range.collect()
}

/// The largest distance between the targets of two descriptions of an arm, over
/// seeded joint values within these ranges, m.
pub(super) fn farthest(model: &Model, a: &Identified, b: &Identified) -> f64 {
    let ranges = ranges(model);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let arms = [a, b].map(|arm| chain(&arm.links, arm.base, arm.tool.translation));
    let mut worst = 0.0_f64;
    for _ in 0..POSES {
        let q: Vec<f64> = ranges.iter().map(|[low, high]| rng.random_range(*low..=*high)).collect();
        let [a, b] = arms.each_ref().map(|arm| arm.pose(&q).translation);
        worst = worst.max((a - b).norm());
    }
    worst
}
