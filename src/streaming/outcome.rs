use super::StreamingError;
use crate::arm::ArmParameters;
use crate::scalar::Scalar;
use crate::solve::Misfit;

/// The outcome of [`StreamingIdentification::identified`](super::StreamingIdentification::identified).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Identified<'t, T, const N: usize, const P: usize> {
    /// To be stored: the chosen parameters of the arm changed, `sequence` one higher than
    /// stored; `created`, `rms_before` and `rms_after` are 0, unknown: a controller that counts
    /// with one of them says what holds now before it stores. `covered` is that of the stored
    /// set.
    pub parameters: ArmParameters<'t, T, N>,
    /// By how much each parameter differs from the stored one, in its unit; of a plane or
    /// an anchor from where it is stated to be, see
    /// [`Plane::found`](crate::measurement::Plane::found).
    pub change: [T; P],
    /// Standard deviation of each, in its unit, as lambda / scale^2 and the measurements
    /// leave it: of noise and prior alone. What linearising leaves comes on top, which
    /// after a change of some milliradians is more; and those that faded count as
    /// measured the worse, which overstates it by up to sqrt(2) where nothing moved.
    pub sigma: [T; P],
    /// Whether the measurements, rather than the scale, determine it: its standard
    /// deviation is less than half of `scale / sqrt(lambda)`. Always so without a
    /// scale, though it may be that of another parameter which does.
    pub determined: [bool; P],
    /// Independent directions among the parameters that the measurements show.
    pub rank: usize,
    /// The lambda used.
    pub lambda: T,
    /// RMS distance of all measurements from the stored model, m; of points in 3-D.
    pub rms_before: T,
    /// The same from the new model, linearised. Of fitted measurements: no measure of how good
    /// it is; how bad it is [`Self::misfit`] says.
    pub rms_after: T,
    /// How well the measurements agree with the new model and `sigma`, linearised: not at all
    /// where one of them is wrong, though every parameter is `determined` to the sigma above.
    /// Which one it was is not kept.
    pub misfit: Misfit<T>,
    /// RMS distance of the held-out measurements from the model of the fitted ones
    /// alone, m, linearised; `None` where none was held out.
    pub held_out: Option<T>,
}

impl<T: Scalar, const N: usize, const P: usize> Identified<'_, T, N, P> {
    /// Itself, if the measurements agree with it and it may be stored.
    ///
    /// # Errors
    /// [`StreamingError::Inconsistent`].
    pub fn judged(self) -> Result<Self, StreamingError> {
        if self.misfit.contradicts() {
            return Err(StreamingError::Inconsistent { times: self.misfit.whole_times() });
        }
        Ok(self)
    }
}
