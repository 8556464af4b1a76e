//! A point measured on the running arm, and what the model says of it.

use nalgebra::Vector3;

use crate::arm::{Arm, State};
use crate::parameters::Linearised;
use crate::scalar::Scalar;

/// One measured tool point: the [`tool`](crate::ArmParameters::tool) of the parameters, which
/// carried the reflector when the arm was calibrated. An arm that it is compared with is
/// [`Arm::new`] of them; with a production tool the arm has another point.
///
/// ```
/// use truearm::{Arm6, blob::Blob, check_point::CheckPoint, nalgebra::Vector3};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
/// let arm = Arm6::<f32>::new(&Blob::check(slot)?.parameters()?);
/// let measured = Vector3::new(-0.6, -0.2, 0.5);
/// let q = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
/// let point = CheckPoint::plain(q, measured, arm.reference_temperature());
/// let innovation = point.point - point.predicted(&arm);
/// assert!(point.is_finite() && innovation.norm() > 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CheckPoint<T, const N: usize> {
    /// Encoder readings, rad or m.
    pub q: [T; N],
    /// Approach, payload, temperature and torques at the measurement.
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
        let state = self.state.numbers();
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
