use crate::scalar::Scalar;

/// How a joint came to rest: its link lags behind that motion by half the play.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Approach {
    /// Moving in +q.
    Positive,
    /// Moving in -q.
    Negative,
    /// Not known: the middle of the play.
    #[default]
    Unknown,
}

impl Approach {
    /// Of the last motion of a joint: its change or its velocity, in any unit.
    /// [`Approach::Unknown`] for no motion and for NaN.
    ///
    /// ```
    /// use truearm::Approach;
    ///
    /// assert_eq!(Approach::of_motion(0.1), Approach::Positive);
    /// assert_eq!(Approach::of_motion(-3.0_f32), Approach::Negative);
    /// assert_eq!(Approach::of_motion(0.0), Approach::Unknown);
    /// ```
    #[must_use]
    #[inline]
    pub fn of_motion<T: Scalar>(change: T) -> Self {
        if change > T::ZERO {
            Self::Positive
        } else if change < T::ZERO {
            Self::Negative
        } else {
            Self::Unknown
        }
    }

    /// +1, -1, or 0 if unknown.
    #[must_use]
    #[inline]
    pub fn sign<T: Scalar>(self) -> T {
        match self {
            Self::Positive => T::ONE,
            Self::Negative => -T::ONE,
            Self::Unknown => T::ZERO,
        }
    }
}
