//! The temperature of an arm that follows what is read late.
//!
//! A thermometer stands in the air or on a motor; links are warm later. Their temperature w
//! obeys `tau dw/dt = T - w`. The host identifies tau with this filter, and a controller
//! makes of its readings with it what [`crate::State::temperature`] holds.

use crate::arm::Arm;
use crate::effects::time_constant;
use crate::scalar::Scalar;

/// A step is made when this share of the time constant has passed: in `f32` shorter ones
/// would be rounded away, and a tick of a millisecond need not pay for an exponential.
const STEP: f32 = 1.0 / 16_384.0;

/// A lag of first order, exact for a temperature that goes straight from each reading to the
/// next.
///
/// **Where it starts.** Nothing is known of what was before the first reading: the arm is
/// taken as warm as that says. What is wrong with it decays with the time constant. After a
/// restart of the controller a warm arm in a cold room is taken for cold, or the other way
/// round, for about three time constants.
///
/// ```
/// use truearm::ThermalLag;
///
/// let mut lag = ThermalLag::<f32>::new(1500.0);
/// assert_eq!(lag.step(0.0, 20.0), 20.0);
/// // Ten kelvin more at the motor; after 25 minutes the arm has 1 - 1/e of them.
/// let mut arm = lag.step(0.001, 30.0);
/// for _ in 0..1500 {
///     arm = lag.step(1.0, 30.0);
/// }
/// assert!((arm - 26.32).abs() < 0.02, "{arm}");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThermalLag<T> {
    /// s; 0: none.
    time_constant: T,
    /// The reading that was last used; none before the first.
    reading: Option<T>,
    /// The arm's temperature less that reading, K. Not the temperature itself: small steps
    /// would be lost beside it.
    ahead: T,
    /// Since that reading, s; without a lag since the last that was a number.
    passed: T,
}

impl<T: Scalar> ThermalLag<T> {
    /// Of a time constant in s, before any reading; one that is zero, negative, no number or
    /// so small that a share of it is nothing stands for none.
    #[must_use]
    pub fn new(time_constant: T) -> Self {
        let share = time_constant * T::from_f32(STEP);
        let lags = share > T::ZERO && time_constant.is_finite();
        let time_constant = if lags { time_constant } else { T::ZERO };
        Self { time_constant, reading: None, ahead: T::ZERO, passed: T::ZERO }
    }

    /// The time constant, s; 0: what is read is what the arm has.
    #[must_use]
    pub fn time_constant(&self) -> T {
        self.time_constant
    }

    /// How long ago the last reading was taken that was a number and counted, s, by the `dt` of
    /// [`Self::step`]; `None` before the first. A thermometer that is dead leaves the temperature as
    /// it was for as long as one likes: who asks knows when that is too long. Good to a 16,384th of
    /// the time constant; in `f32` and steps of a millisecond it counts to four hours at least and
    /// may then stand.
    ///
    /// ```
    /// use truearm::ThermalLag;
    ///
    /// let mut lag = ThermalLag::<f32>::new(0.0);
    /// assert_eq!(lag.since(), None);
    /// lag.step(1.0, 20.0);
    /// lag.step(1.0, f32::NAN);
    /// assert_eq!((lag.step(1.0, f32::NAN), lag.since()), (20.0, Some(2.0)));
    /// lag.step(1.0, 21.0);
    /// assert_eq!(lag.since(), Some(0.0));
    /// ```
    #[must_use]
    pub fn since(&self) -> Option<T> {
        self.reading.map(|_| self.passed)
    }

    /// The temperature of the arm, degrees Celsius, at a reading that was taken `dt` seconds
    /// after the call before; of the first call `dt` does not count. Call it as often as you
    /// like, once a second or in every tick.
    ///
    /// A reading that is no number lets time pass and leaves the temperature as it was, which
    /// before the first reading is no number either. A `dt` below zero or no number is no time.
    pub fn step(&mut self, dt: T, reading: T) -> T {
        let Some(last) = self.reading else {
            if reading.is_finite() {
                self.reading = Some(reading);
            }
            return reading;
        };
        if dt > T::ZERO && (self.passed + dt).is_finite() {
            self.passed += dt;
        }
        if !reading.is_finite() || self.passed < self.time_constant * T::from_f32(STEP) {
            return last + self.ahead;
        }
        if self.time_constant > T::ZERO {
            let constants = self.passed / self.time_constant;
            let share = constants.settled();
            let ahead = self.ahead - self.ahead * share - (reading - last) * (share / constants);
            // Readings so far apart that numbers end are none: what is kept stays a number.
            if !(reading + ahead).is_finite() {
                return last + self.ahead;
            }
            self.ahead = ahead;
        }
        self.passed = T::ZERO;
        self.reading = Some(reading);
        reading + self.ahead
    }
}

impl<T: Scalar, const N: usize> Arm<'_, T, N> {
    /// What makes of the temperatures that are read that of [`crate::State::temperature`]: the
    /// readings themselves, unless the arm was found to follow them late.
    #[must_use]
    pub fn thermal_lag(&self) -> ThermalLag<T> {
        ThermalLag::new(time_constant(self.terms()))
    }
}
