use crate::scalar::Scalar;

/// By how much a standard deviation may be stated too small: noise is known within a factor
/// of two at best.
const STATED: f32 = 2.0;
/// Quantile of the standard normal distribution that 1e-4 are beyond.
const RARE: f32 = 3.719;

/// How well a fit agrees with the noise that was stated.
///
/// The squared residuals of a fit, each over its standard deviation, have a sum that is
/// chi-square of [`Self::freedom`] degrees while noise is normal and stated rightly: their
/// mean is 1, whatever was measured. A reading that is wrong, a model that does not hold and
/// a sigma that is too small make it larger, by the square of how much they are off. Sigma is
/// of a reading about the model of a sound arm, which leaves more than a good tracker's noise.
///
/// **What it does not see.** A fit of as many equations as unknowns goes through every
/// reading, wrong or not: with few degrees of freedom what one reading is off by goes into
/// the parameters and not into the misfit. It is a measure of how bad a fit is, never of how
/// good the parameters are: these are as good as poses and readings let them be.
///
/// ```
/// use truearm::solve::Misfit;
///
/// // Ten points of a tracker and six unknowns: 24 degrees of freedom.
/// let good = Misfit { chi_square: 25.0_f32, freedom: 24.0 };
/// assert!(!good.contradicts());
/// // One point that is off by 50 sigma.
/// let bad = Misfit { chi_square: 25.0 + 0.7 * 50.0 * 50.0, freedom: 24.0 };
/// assert!(bad.contradicts() && bad.times() > 8.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Misfit<T> {
    /// Sum of the squared residuals, each over its standard deviation; without the prior.
    pub chi_square: T,
    /// Its mean under the stated noise: equations less the unknowns that they, and not the
    /// prior, determine. A direction that the prior holds by half takes half a degree.
    pub freedom: T,
}

impl<T: Scalar> Misfit<T> {
    /// The reduced chi-square: 1 on average, and 1 +- `sqrt(2 / freedom)` as a rule, where
    /// sigma is stated rightly. Below one degree of freedom over one.
    #[must_use]
    pub fn reduced(&self) -> T {
        self.chi_square / self.degrees()
    }

    /// How many times the stated sigma the readings scatter about the fit.
    #[must_use]
    pub fn times(&self) -> T {
        self.reduced().sqrt()
    }

    /// Largest [`Self::reduced`] that does not contradict the stated noise: what a sigma that
    /// is twice as large exceeds once in 10,000 fits. 4 times 2.4 with 24 degrees of freedom,
    /// 4 times 16 with one, 4 times 1.2 with 1,000.
    ///
    /// The quantile is that of Wilson and Hilferty (*The distribution of chi-square*, PNAS 17,
    /// 1931), above the true one by 7 % with one degree and by less with more. Between whole
    /// degrees, where a prior holds directions by part, the sum has shorter tails than
    /// chi-square has: Chernoff's bound of a weighted sum with weights up to 1 lies below.
    #[must_use]
    pub fn most(&self) -> T {
        let spread = T::from_f32(2.0 / 9.0) / self.degrees();
        let root = T::ONE - spread + T::from_f32(RARE) * spread.sqrt();
        T::from_f32(STATED * STATED) * root * root * root
    }

    /// Whether readings contradict the fit so much that its parameters must not be stored: a
    /// reading is wrong, the arm is not what the unknowns let it be, or sigma is stated by more
    /// than half too small. A misfit that is no number does as well.
    #[must_use]
    pub fn contradicts(&self) -> bool {
        let within = self.reduced() <= self.most();
        !within
    }

    /// As an error has it: [`Self::times`], rounded up.
    pub(crate) fn whole_times(&self) -> u32 {
        // Saturates; NaN is 0.
        (self.times().to_f64() as u32).saturating_add(1)
    }

    /// With fewer than one the quantile of one is above that of the sum.
    fn degrees(&self) -> T {
        if self.freedom > T::ONE { self.freedom } else { T::ONE }
    }
}
