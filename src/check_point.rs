//! A point measured on the running arm, and what the model says of it.

use nalgebra::Vector3;

use crate::arm::{Arm, State};
use crate::parameters::Linearised;
use crate::scalar::Scalar;

/// One measured tool point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CheckPoint<T, const N: usize> {
    /// Encoder readings, rad or m.
    pub q: [T; N],
    /// Approach, payload and temperature at the measurement.
    pub state: State<T, N>,
    /// The measured tool point, m: in the commanded frame, or in that of a
    /// tracker whose place is unknown.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub point: Vector3<T>,
}

impl<T: Scalar, const N: usize> CheckPoint<T, N> {
    /// Measured at the arm's reference temperature, without payload.
    #[must_use]
    pub fn plain(q: [T; N], point: Vector3<T>, reference_temperature: T) -> Self {
        Self { q, state: State::at(reference_temperature), point }
    }

    /// Whether every number of it is one.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let state = [&self.state.payload, &self.state.temperature];
        self.q.iter().chain(state).chain(self.point.iter()).all(|v| v.is_finite())
    }

    /// Where the model sees the tool point, m, in the commanded frame.
    #[must_use]
    pub fn predicted(&self, arm: &Arm<T, N>) -> Vector3<T> {
        arm.real_pose_in(&self.q, &self.state).translation
    }

    /// The same with its derivatives to every parameter, taken where the joints
    /// really are.
    #[must_use]
    pub fn linearised<'a>(&self, arm: &'a Arm<T, N>) -> Linearised<'a, T, N> {
        arm.linearised(&self.q, &self.state)
    }
}
