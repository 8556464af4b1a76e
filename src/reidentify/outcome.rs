use super::ReidentifyError;
use crate::arm::ArmParameters;
use crate::kinematics::Pose;
use crate::scalar::Scalar;
use crate::solve::Misfit;

/// The outcome of [`Reidentify::run`](super::Reidentify::run).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reidentified<'t, T, const N: usize, const P: usize> {
    /// To be stored: the chosen parameters changed, `sequence` one higher; `created`,
    /// `rms_before` and `rms_after` are 0, unknown: a controller that counts with one of them,
    /// as with the sigma of a [`DriftWatch`](crate::drift::DriftWatch), says what holds now
    /// before it stores. `covered` is that of the stored set: these measurements mend its
    /// identification and do not replace it.
    pub parameters: ArmParameters<'t, T, N>,
    /// From the commanded to the points' frame; the identity unless the
    /// tracker's place was unknown.
    pub station: Pose<T>,
    /// By how much each parameter changed, in its unit; zero for the tracker. Of a plane
    /// or an anchor from where it is stated to be, see
    /// [`Plane::found`](crate::measurement::Plane::found).
    pub change: [T; P],
    /// Standard deviation of each after the fit, in its unit.
    pub sigma: [T; P],
    /// Whether the measurements, rather than the prior, determine it: its standard
    /// deviation is less than half of its scale. Always so without a prior, though
    /// it may be that of another parameter which does, as the base's beside an unknown
    /// tracker: then `rank` is less than the number of parameters.
    pub determined: [bool; P],
    /// Independent directions among the parameters that the measurements show.
    pub rank: usize,
    /// RMS distance of the measurements from the stored model, m; of points in 3-D. With
    /// a tracker, plane or anchor of unknown place after fitting that alone.
    pub rms_before: T,
    /// The same from the new model. Of fitted measurements: no measure of how good it is; how
    /// bad it is [`Self::misfit`] says.
    pub rms_after: T,
    /// How well the measurements agree with the new model and `sigma`: not at all where one of
    /// them is wrong, though every parameter is `determined` to the sigma above.
    pub misfit: Misfit<T>,
    /// 0-based index of the measurement that is farthest from the new model, by coordinate: of
    /// one that is wrong, as a rule that one.
    pub worst: usize,
    /// Gauss-Newton steps taken.
    pub steps: u8,
}

impl<T: Scalar, const N: usize, const P: usize> Reidentified<'_, T, N, P> {
    /// Itself, if the measurements agree with it and it may be stored.
    ///
    /// # Errors
    /// [`ReidentifyError::Inconsistent`].
    pub fn judged(self) -> Result<Self, ReidentifyError> {
        if self.misfit.contradicts() {
            let (times, worst) = (self.misfit.whole_times(), self.worst);
            return Err(ReidentifyError::Inconsistent { times, worst });
        }
        Ok(self)
    }
}

/// What a model leaves of measurements.
pub(super) struct Residuals<T> {
    /// Of the squares, m^2.
    pub sum: T,
    /// Of measurements.
    pub count: T,
    pub equations: u32,
    /// Index of the one with the largest mean square of a coordinate.
    pub worst: usize,
}

impl<T: Scalar> Residuals<T> {
    /// Of a measurement, m.
    pub fn rms(&self) -> T {
        (self.sum / self.count).sqrt()
    }
}
