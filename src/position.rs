//! The real position: where the tool is at encoder readings, how sure that is,
//! and whether the identification has seen such a pose.

use crate::arm::{Arm, State};
use crate::blob::{Covariance, CovarianceError};
use crate::kinematics::Pose;
use crate::scalar::Scalar;

/// Where the tool really is.
///
/// ```
/// use truearm::{Arm6, RealPosition, blob::Blob};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
/// let arm = Arm6::<f32>::new(&Blob::check(slot)?.parameters()?);
/// let position = RealPosition::of(&arm, &[0.1, -1.2, 1.6, -1.2, -1.57, 0.8], &arm.state());
/// if !position.covered {
///     // Extrapolated: the identification has seen no such joint values.
/// }
/// assert_eq!(position.sigma, None, "no covariance was given");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RealPosition<T> {
    /// Tool pose in the commanded frame, the nominal base.
    pub pose: Pose<T>,
    /// One standard deviation of the tool point along x, y, z, m, from the
    /// identified covariance; `None` where none was given. It holds in the joint
    /// ranges that the identification covered, and in gaps of a curve with the wider band there.
    pub sigma: Option<[T; 3]>,
    /// The identification [covers](Arm::covers) every joint's value; elsewhere the
    /// corrections are extrapolated.
    pub covered: bool,
    /// The data determined the orientation of the flange. If not, the
    /// directions that points cannot see are nominal.
    pub orientation_identified: bool,
}

impl<T: Scalar> RealPosition<T> {
    /// At encoder readings `q` (rad or m) in a state of the arm. Not finite where
    /// `q` is not, see [`Arm::real_pose_in`].
    #[must_use]
    pub fn of<const N: usize>(arm: &Arm<T, N>, q: &[T; N], state: &State<T, N>) -> Self {
        Self {
            pose: arm.real_pose_in(q, state),
            sigma: None,
            covered: arm.covers(q),
            orientation_identified: arm.orientation_identified(),
        }
    }

    /// The same, with how sure it is. A pose costs about a thousand instructions, its
    /// covariance tens of thousands: see [`Covariance::point_sigma`].
    ///
    /// # Errors
    /// The covariance is not that of this arm's parameters.
    pub fn with_sigma<const N: usize>(
        arm: &Arm<T, N>,
        q: &[T; N],
        state: &State<T, N>,
        covariance: &Covariance<'_>,
    ) -> Result<Self, CovarianceError> {
        let sigma = Some(covariance.point_sigma(arm, q, state)?);
        Ok(Self { sigma, ..Self::of(arm, q, state) })
    }
}
