//! Where the tool really is: nominal geometry, identified corrections and the
//! robot frame they refer to.

use nalgebra::Vector3;

use crate::kinematics::{Chain, Link, MdhParameters, Pose};
use crate::scalar::Scalar;

/// Everything a controller has to know of an identified arm, SI units; what a
/// parameter blob carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmParameters<T, const N: usize> {
    /// Hash of the robot's model name and serial, see [`crate::blob::robot_id`].
    pub robot_id: u64,
    /// Grows with every parameter set of a robot.
    pub sequence: u32,
    /// Nominal links, as the controller's own kinematics has them.
    pub nominal: [Link<T>; N],
    /// Identified corrections, added to the nominal parameters.
    pub corrections: [MdhParameters<T>; N],
    /// Small rigid transform from the identified to the commanded (nominal
    /// base) frame: translation, m.
    pub base_translation: Vector3<T>,
    /// The same: rotation vector, rad.
    pub base_rotation: Vector3<T>,
    /// Default tool point in the identified flange frame, m.
    pub tool: Vector3<T>,
    /// Joint limits, rad or m.
    pub limits: [Option<[T; 2]>; N],
    /// Smallest and largest joint values of the identification, rad or m.
    /// Poses outside are extrapolation.
    pub covered: [Option<[T; 2]>; N],
    /// RMS position error before identification, m.
    pub rms_before: T,
    /// Cross-validated RMS position error after identification, m.
    pub rms_after: T,
    /// Whether the data determined the orientation of the flange, or only
    /// points were measured and unseen directions are nominal.
    pub orientation_identified: bool,
}

/// An identified arm, folded for the control loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arm<T, const N: usize> {
    nominal: Chain<T, N>,
    real: Chain<T, N>,
    covered: [Option<[T; 2]>; N],
}

impl<T: Scalar, const N: usize> Arm<T, N> {
    /// Adds the corrections to the nominal links and folds both chains. Call
    /// it once, at load time.
    #[must_use]
    pub fn new(parameters: &ArmParameters<T, N>) -> Self {
        let p = parameters;
        let tool = Pose { translation: p.tool, ..Pose::identity() };
        let base = Pose::from_rotation_vector(p.base_translation, p.base_rotation);
        let mut links = p.nominal;
        for (link, correction) in links.iter_mut().zip(&p.corrections) {
            *link = link.corrected(correction);
        }
        Self {
            nominal: Chain::new(&p.nominal, Pose::identity(), tool),
            real: Chain::new(&links, base, tool),
            covered: p.covered,
        }
    }

    /// The same arm with the production tool, a pose in the flange frame.
    #[must_use]
    pub fn with_tool(&self, tool: Pose<T>) -> Self {
        Self {
            nominal: self.nominal.with_tool(tool),
            real: self.real.with_tool(tool),
            covered: self.covered,
        }
    }

    /// The chain the controller believes in.
    #[must_use]
    pub fn nominal(&self) -> &Chain<T, N> {
        &self.nominal
    }

    /// The identified chain.
    #[must_use]
    pub fn real(&self) -> &Chain<T, N> {
        &self.real
    }

    /// Where the tool really is at encoder readings `q` (rad or m), in the
    /// commanded frame, the nominal base.
    #[must_use]
    #[inline]
    pub fn real_pose(&self, q: &[T; N]) -> Pose<T> {
        self.real.forward(q)
    }

    /// Whether every joint lies within the range that the identification
    /// covered. Outside of it the corrections are extrapolated.
    #[must_use]
    pub fn covers(&self, q: &[T; N]) -> bool {
        self.covered.iter().zip(q).all(|(range, q)| match range {
            Some([low, high]) => *low <= *q && *q <= *high,
            None => false,
        })
    }
}
