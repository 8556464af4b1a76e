use std::path::PathBuf;

use nalgebra::{Rotation3, Vector3};
use truearm::{JointKind, Link, Pose};

use super::arm::chain;
use super::prior::LinkPrior;

/// The nominal arm, as `robot.toml` describes it, in SI units.
#[derive(Debug, Clone)]
pub struct Robot {
    /// The file it came from.
    pub path: PathBuf,
    /// Model name.
    pub name: String,
    /// Serial number; empty if not given.
    pub serial: String,
    /// Standard deviation of a measured coordinate, repeatability included, m.
    pub sigma: f64,
    /// The same of a measured orientation about an axis, rad; `None` if not
    /// stated.
    pub sigma_angle: Option<f64>,
    /// Gravity in the frame before joint 1, m/s^2.
    pub gravity: Option<Vector3<f64>>,
    /// Temperature the nominal geometry refers to, degrees Celsius.
    pub reference_temperature: f64,
    /// The joints from base to flange.
    pub joints: Vec<Joint>,
    /// The frame before joint 1 in the frame of the files' coordinates: of
    /// gravity, commanded points, boxes and trackers. Joint 1 has no parameter
    /// for what it holds. Everything but the files is in the frame before joint 1.
    pub base: Placement,
    /// Target in the last frame, m.
    pub tool: Vector3<f64>,
    /// How the target's frame is turned in the last frame, as in [`Placement`].
    pub tool_rpy: Vector3<f64>,
    /// Masses of the links; empty if not given.
    pub links: Vec<LinkMass>,
    /// Centre of mass of the payload in the last frame; the tool point if not given, m.
    pub payload: Vector3<f64>,
    /// Remarks for the user.
    pub warnings: Vec<String>,
}

/// A frame as a user states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Its origin, m.
    pub xyz: Vector3<f64>,
    /// Turns about the fixed axes x, then y, then z, rad: `R = Rz Ry Rx`.
    pub rpy: Vector3<f64>,
}

impl Default for Placement {
    fn default() -> Self {
        Self { xyz: Vector3::zeros(), rpy: Vector3::zeros() }
    }
}

impl Placement {
    /// As a transform from the frame to the one it is stated in.
    #[must_use]
    pub fn pose(&self) -> Pose<f64> {
        let turn = Rotation3::from_euler_angles(self.rpy.x, self.rpy.y, self.rpy.z);
        Pose { rotation: turn.into_inner(), translation: self.xyz }
    }

    /// Of a transform; [`Placement::pose`] gives it back to rounding, also where
    /// the middle turn is a quarter and the outer two are about one axis.
    #[must_use]
    pub fn of(pose: &Pose<f64>) -> Self {
        let r = &pose.rotation;
        let yaw = r[(1, 0)].atan2(r[(0, 0)]);
        // Turned back by this yaw, the rest is Ry Rx however noisy the yaw was.
        let (sin, cos) = yaw.sin_cos();
        let roll = (sin * r[(0, 2)] - cos * r[(1, 2)]).atan2(cos * r[(1, 1)] - sin * r[(0, 1)]);
        let pitch = (-r[(2, 0)]).atan2(cos * r[(0, 0)] + sin * r[(1, 0)]);
        Self { xyz: pose.translation, rpy: Vector3::new(roll, pitch, yaw) }
    }
}

/// A joint and the link before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Kind and nominal MD-H parameters.
    pub link: Link<f64>,
    /// Limits, rad or m.
    pub limits: Option<[f64; 2]>,
    /// Input turns per output turn.
    pub gear_ratio: Option<f64>,
    /// Corrections of the link in arms of this type.
    pub prior: LinkPrior,
}

/// Mass of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkMass {
    /// kg
    pub mass: f64,
    /// Centre of mass in the link's frame, m.
    pub com: Vector3<f64>,
}

/// How an arm may be mounted of which no file says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mounting {
    /// z of the files' coordinates is up.
    Upright,
    /// It is down.
    Hanging,
}

/// Gravity where files do not state it, m/s^2.
const DOWN: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

impl Robot {
    /// Whether gravity's torques can be computed.
    #[must_use]
    pub fn is_weighed(&self) -> bool {
        self.gravity.is_some() && !self.links.is_empty()
    }

    /// The arm with what its loads need where that is not stated. Without gravity it
    /// is mounted so. Without masses every link has 1 kg half way to the next joint:
    /// gravity torques then have about the right shape and an unknown size, which the
    /// compliance coefficient takes up. `None` where both are stated.
    #[must_use]
    pub fn with_assumed_loads(&self, mounting: Mounting) -> Option<Self> {
        if self.is_weighed() {
            return None;
        }
        let mut robot = self.clone();
        let path = self.path.display();
        if self.gravity.is_none() {
            let (sign, stands) = match mounting {
                Mounting::Upright => (1.0, "stands upright (gravity along -z"),
                Mounting::Hanging => (-1.0, "hangs, as they say (gravity along +z"),
            };
            robot.gravity = Some(self.base.pose().rotation.tr_mul(&DOWN) * sign);
            robot.warnings.push(format!(
                "{path}: no gravity_m_s2: springs are tested as of an arm that {stands} of the \
                 files' coordinates, [base]); state it"
            ));
        }
        if self.links.is_empty() {
            robot.links = self.assumed_masses();
            robot.warnings.push(format!(
                "{path}: no [[links]]: compliance is tested with 1 kg assumed half way along every \
                 link; its coefficients are per assumed N m"
            ));
        }
        Some(robot)
    }

    fn assumed_masses(&self) -> Vec<LinkMass> {
        let next = |i: usize| match self.joints.get(i + 1) {
            // Origin of the next joint's frame, seen from this one's.
            Some(joint) => {
                let p = &joint.link.parameters;
                Vector3::new(p.a, -p.d * p.alpha.sin(), p.d * p.alpha.cos())
            }
            None => self.tool,
        };
        (0..self.joints.len()).map(|i| LinkMass { mass: 1.0, com: next(i) / 2.0 }).collect()
    }

    /// Where the nominal target is at joint values, in the coordinates of the
    /// files.
    pub fn nominal_target(&self) -> impl Fn(&[f64]) -> Pose<f64> + use<> {
        let arm = chain(&self.nominal(), self.base.pose(), self.tool);
        let turn = Placement { xyz: Vector3::zeros(), rpy: self.tool_rpy }.pose();
        move |q| arm.pose(q).compose(&turn)
    }

    /// All lengths of the arm together, m: no point of it is farther from its base.
    #[must_use]
    pub fn reach(&self) -> f64 {
        let links = self.joints.iter().map(|j| {
            let p = &j.link.parameters;
            let slide = match (j.link.kind, j.limits) {
                (JointKind::Prismatic, Some([low, high])) => low.abs().max(high.abs()),
                _ => 0.0,
            };
            p.a.abs() + p.d.abs() + slide
        });
        links.sum::<f64>() + self.tool.norm()
    }

    /// The nominal links.
    #[must_use]
    pub fn nominal(&self) -> Vec<Link<f64>> {
        self.joints.iter().map(|j| j.link).collect()
    }
}
