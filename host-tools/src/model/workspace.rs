use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;

use super::robot::{Joint, Robot};
use crate::error::{Error, ErrorKind, Result};
use crate::units::{joint_from_file, joint_to_file};

/// A pose is given up for when so many draws gave none.
const MOST_TRIES: usize = 20_000;

/// Where the arm may go in a measurement, SI, in the coordinates of the files.
#[derive(Debug, Clone, PartialEq)]
pub struct Workspace {
    /// Of each joint, rad or m.
    pub limits: Vec<[f64; 2]>,
    /// Two corners that the target must stay between, m.
    pub corners: Option<[Vector3<f64>; 2]>,
    /// What the tracker can see.
    pub sight: Option<Sight>,
}

/// Line of sight: the tracker sees the target where the angle between the
/// target's axis and the direction to the tracker is within the target's cone.
/// What else may stand in the way, the arm's own links included, is not
/// modelled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The tracker in the coordinates of the files, m.
    pub tracker: Vector3<f64>,
    /// Axis of the target in its own frame.
    pub axis: Vector3<f64>,
    /// Half angle of the cone, rad.
    pub cone: f64,
}

impl Workspace {
    /// Within the limits of the robot file, or these.
    ///
    /// # Errors
    /// Joints without limits, or another number of them.
    pub fn new(robot: &Robot, limits: Option<Vec<[f64; 2]>>) -> Result<Self> {
        let joints = robot.joints.len();
        if let Some(limits) = limits {
            if limits.len() != joints {
                return Err(Error::data(
                    ErrorKind::NoPoses,
                    format!("limits of {} joints, but the robot has {joints}", limits.len()),
                    "give low:high for every joint, separated by commas",
                ));
            }
            if let Some([low, high]) = limits.iter().find(|[low, high]| low > high) {
                return Err(Error::data(
                    ErrorKind::NoPoses,
                    format!("limits from {low} to {high} rad or m"),
                    "give the lower limit first",
                ));
            }
            return Ok(Self { limits, corners: None, sight: None });
        }
        let missing: Vec<String> = (0..joints)
            .filter(|j| robot.joints[*j].limits.is_none())
            .map(|j| (j + 1).to_string())
            .collect();
        if !missing.is_empty() {
            return Err(Error::data(
                ErrorKind::NoPoses,
                format!("{}: no limits of joints {}", robot.path.display(), missing.join(", ")),
                "add limits_deg (limits_mm) to its [[joints]], or give --limits low:high,... \
                 for all joints",
            ));
        }
        let limits = robot.joints.iter().filter_map(|j| j.limits).collect();
        Ok(Self { limits, corners: None, sight: None })
    }

    /// Whether the nominal target may be there.
    #[must_use]
    pub fn admits(&self, target: &Pose<f64>) -> bool {
        let p = &target.translation;
        let inside = self.corners.is_none_or(|[low, high]| {
            (0..3).all(|c| (low[c].min(high[c])..=low[c].max(high[c])).contains(&p[c]))
        });
        inside
            && self.sight.is_none_or(|sight| {
                let axis = target.rotation * sight.axis.normalize();
                let way = sight.tracker - p;
                axis.dot(&way) >= sight.cone.cos() * way.norm()
            })
    }

    /// Joint values uniform within the limits, rounded as [`Self::sample`] does,
    /// wherever the target then is.
    #[must_use]
    pub fn draw(&self, robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let joints = self.limits.iter().zip(&robot.joints);
        let value = |([low, high], joint): (&[f64; 2], &Joint)| {
            let value = joint_to_file(joint.link.kind, rng.random_range(*low..=*high));
            joint_from_file(joint.link.kind, (value * 1e3).round() / 1e3)
        };
        joints.map(value).collect()
    }

    /// Random poses of the workspace, every joint uniform within its limits and
    /// rounded to what a controller is told (0.001 degrees, 0.001 mm).
    ///
    /// # Errors
    /// When the arm hardly ever gets there.
    pub fn sample(
        &self,
        robot: &Robot,
        count: usize,
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<Vec<f64>>> {
        let target = robot.nominal_target();
        let mut out = Vec::new();
        let mut tries = 0;
        while out.len() < count {
            let q = self.draw(robot, rng);
            tries += 1;
            if self.admits(&target(&q)) {
                out.push(q);
                tries = 0;
            } else if tries > MOST_TRIES {
                return Err(Error::data(
                    ErrorKind::NoPoses,
                    format!(
                        "of {MOST_TRIES} random poses within the joint limits none is in the box \
                         and in the tracker's sight"
                    ),
                    "the box and the tracker are in mm in the frame that [base] of robot.toml is \
                     stated in, the target's axis in that of [tool]; widen them or --cone-deg",
                ));
            }
        }
        Ok(out)
    }
}
