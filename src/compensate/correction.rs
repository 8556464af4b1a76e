//! A correction in the making, and what keeps it within its bounds.

use super::damped::System;
use super::outcome::Joints;
use crate::arm::Bent;
use crate::kinematics::{Pose, Turns, Twist};
use crate::scalar::Scalar;

/// A correction and how it came about; and what is computed on the way, which
/// stays in place, for a tick has no time for copies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Correction<T, const N: usize> {
    /// To be added to the command, rad or m.
    pub joints: [T; N],
    /// Where the nominal arm has its tool at the command, in the frame that the first
    /// joint of the identified one turns in.
    pub target: Pose<T>,
    /// Joints at their largest correction, to which all were scaled.
    pub bound: Joints,
    /// Whether a correction of the largest size could reach a limit.
    pub near_limit: bool,
    /// Joints so near a limit that they correct less than their share.
    pub limited: Joints,
    /// Weight of each joint in the solution: 1, falling to 0 at a limit.
    pub share: [T; N],
    /// Largest correction of each joint.
    pub most: [T; N],
    /// Jacobian of the nominal arm at the command, weighed.
    pub columns: [Twist<T>; N],
    pub system: System<T>,
    /// The nominal arm at the command, the identified one there, and either
    /// somewhere near.
    pub nominal: Turns<T, N>,
    pub identified: Turns<T, N>,
    pub near: Turns<T, N>,
    pub bent: Bent<T, N>,
    /// The solution in the directions of the task.
    pub along: Twist<T>,
    /// What it makes of the angles of the rigid chain.
    pub rigid: [T; N],
}

impl<T: Scalar, const N: usize> Correction<T, N> {
    /// None yet, of joints that may be corrected by so much at most.
    pub fn none(most: [T; N]) -> Self {
        let none = [T::ZERO; N];
        Self {
            joints: none,
            target: Pose::identity(),
            bound: Joints::default(),
            near_limit: false,
            limited: Joints::default(),
            share: [T::ONE; N],
            most,
            columns: [Twist::zero(); N],
            system: System::none(),
            nominal: Turns::none(),
            identified: Turns::none(),
            near: Turns::none(),
            bent: Bent::none(),
            along: Twist::zero(),
            rigid: none,
        }
    }

    /// mu, 0 away from singular poses, m^2.
    pub fn damping(&self) -> T {
        self.system.damping[0]
    }

    /// A number times zero is zero; an infinity or a NaN is NaN.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.joints.iter().fold(T::ZERO, |zero, x| zero + *x * T::ZERO) == T::ZERO
    }

    #[cold]
    #[inline(never)]
    pub fn share_out(&mut self) {
        for (rigid, share) in self.rigid.iter_mut().zip(&self.share) {
            *rigid *= *share;
        }
    }

    /// Scales all so that no joint is corrected by more than it may be.
    #[cold]
    #[inline(never)]
    pub fn shrink(&mut self) {
        let mut scale = T::ONE;
        for (i, (x, most)) in self.joints.iter().zip(&self.most).enumerate() {
            let size = x.abs();
            if size > *most {
                self.bound.insert(i);
                let fits = *most / size;
                if fits < scale {
                    scale = fits;
                }
            }
        }
        // Of a solution of 1e26 rad (1e60 in f64) nothing is taken: the scale would be subnormal
        // further on, and what it gives off by far more than a rounding.
        if scale < T::EPSILON * T::EPSILON * T::EPSILON * T::EPSILON {
            scale = T::ZERO;
        }
        for x in self.joints.iter_mut().chain(&mut self.rigid) {
            *x *= scale;
        }
        self.along.linear *= scale;
        self.along.angular *= scale;
    }
}
