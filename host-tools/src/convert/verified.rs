use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{JointKind, Pose};

use super::frames::angle_between;
use crate::error::{Error, ErrorKind, Result};
use crate::model::Robot;

/// Poses at which two descriptions of an arm are compared, beside zero.
const POSES: usize = 200;
/// How far they may be apart, m and rad.
const TOLERANCE: f64 = 1e-9;

/// Reads the text of a robot.toml and compares its target with the pose of the
/// arm it was made of, at zero and at seeded joint values within the limits, or
/// a turn or a metre where there are none. The largest distance found, m.
///
/// # Errors
/// What the reader refuses, or arms that differ by more than 1e-9 m or rad:
/// that is an error of truearm.
pub fn verified(
    text: &str,
    limits: &[Option<[f64; 2]>],
    pose: impl Fn(&[f64]) -> Pose<f64>,
) -> Result<f64> {
    let robot = Robot::parse(Path::new("robot.toml"), text)?;
    let target = robot.nominal_target();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut worst = 0.0_f64;
    for k in 0..=POSES {
        let value = |(joint, limits): (&crate::model::Joint, &Option<[f64; 2]>)| {
            let [low, high] = limits.unwrap_or(match joint.link.kind {
                JointKind::Revolute => [-std::f64::consts::PI, std::f64::consts::PI],
                JointKind::Prismatic => [-1.0, 1.0],
            });
            if k == 0 { 0.0 } else { rng.random_range(low..=high) }
        };
        let q: Vec<f64> = robot.joints.iter().zip(limits).map(value).collect();
        let (made, given) = (target(&q), pose(&q));
        let apart = (made.translation - given.translation).norm();
        let turned = angle_between(&made, &given);
        // Asked for what is good, or NaN would pass.
        let good = apart <= TOLERANCE && turned <= TOLERANCE;
        if !good {
            return Err(Error::data(
                ErrorKind::Refused,
                format!("the arm that was made is {apart:.1e} m and {turned:.1e} rad off at {q:?}"),
                "nothing is written; this is an error of truearm, please report it with the file",
            ));
        }
        worst = worst.max(apart);
    }
    Ok(worst)
}
