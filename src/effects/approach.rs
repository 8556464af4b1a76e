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

    /// How a joint has come to where it is, tick after tick: that of its motion, where it moves
    /// by more than `standstill` (in the unit of `change`, not negative), else as before. What a
    /// controller keeps of each joint: at rest [`Self::of_motion`] knows nothing, and the noise
    /// of an encoder would take the link from one side of the play to the other.
    ///
    /// ```
    /// use truearm::Approach;
    ///
    /// let (start, standstill) = (Approach::Unknown, 1e-5);
    /// let came = start.after(0.02, standstill);
    /// assert_eq!(came, Approach::Positive);
    /// assert_eq!(came.after(-2e-6, standstill), Approach::Positive, "it rests, and trembles");
    /// assert_eq!(came.after(-0.01, standstill), Approach::Negative);
    /// ```
    #[must_use]
    #[inline]
    pub fn after<T: Scalar>(self, change: T, standstill: T) -> Self {
        if change.abs() > standstill { Self::of_motion(change) } else { self }
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
