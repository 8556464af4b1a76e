use nalgebra::Vector3;

use crate::kinematics::{Chain, LinkFrame};
use crate::kinematics::{cross, dot};
use crate::scalar::Scalar;

/// Masses that load an arm; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Masses<T, const N: usize> {
    /// Gravity in the frame of the chain's base, m/s^2.
    pub gravity: Vector3<T>,
    /// Mass of each link, kg.
    pub mass: [T; N],
    /// Centre of mass of each link in its own frame (behind its joint), m.
    pub com: [Vector3<T>; N],
    /// Centre of mass of the payload in the last frame, m.
    pub payload_com: Vector3<T>,
}

/// What gravity does to an arm at one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load<T, const N: usize> {
    /// Generalised force of gravity on each joint, positive in +q: N m, or N
    /// for a prismatic joint.
    pub torque: [T; N],
    /// Overturning moment about the base's x and y axes, N m.
    pub moment: [T; 2],
}

impl<T: Scalar, const N: usize> Load<T, N> {
    /// No load.
    #[must_use]
    pub fn none() -> Self {
        Self { torque: [T::ZERO; N], moment: [T::ZERO; 2] }
    }
}

impl<T: Scalar, const N: usize> Masses<T, N> {
    /// Gravity torque of every joint and overturning moment of the base, at
    /// joint values `q` with `payload` kg at the payload point; exact for the
    /// rigid arm. The chain's base pose must be the frame of `gravity`.
    #[must_use]
    pub fn load(&self, chain: &Chain<T, N>, q: &[T; N], payload: T) -> Load<T, N> {
        let frames = chain.link_frames(q);
        let mut load = Load::none();
        // Mass and first moment of all that hangs on the joint, from the tip.
        let mut mass = payload;
        let mut moment = match frames.last() {
            Some(last) => last.point(&self.payload_com) * payload,
            None => return load,
        };
        let links = frames.iter().zip(self.mass.iter().zip(&self.com));
        for ((frame, (m, com)), torque) in links.zip(&mut load.torque).rev() {
            mass += *m;
            moment += frame.point(com) * *m;
            let arm = moment - frame.on_axis * mass;
            *torque = if frame.prismatic {
                dot(&frame.axis, &self.gravity) * mass
            } else {
                dot(&frame.axis, &cross(&arm, &self.gravity))
            };
        }
        let base = chain.base();
        let about = cross(&(moment - base.translation * mass), &self.gravity);
        load.moment = [
            dot(&crate::kinematics::axis(&base.rotation, 0), &about),
            dot(&crate::kinematics::axis(&base.rotation, 1), &about),
        ];
        load
    }
}

impl<T: Scalar> LinkFrame<T> {
    fn point(&self, p: &Vector3<T>) -> Vector3<T> {
        self.origin + self.x * p.x + self.y * p.y + self.z * p.z
    }
}
