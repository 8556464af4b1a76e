//! The two number types of the crate and every elementary function it uses.
//!
//! All sines, cosines, exponentials and square roots of the crate come from this file: from
//! `libm` or from our own polynomial, never from the platform. Together with
//! Rust's promise not to contract or reorder floating-point operations this
//! makes results bit-identical between a host and a Cortex-M.

use core::fmt::{Debug, Display, LowerExp};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

mod single;

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A real number: `f32` or `f64`. Sealed, because the error bounds and the
/// bit-identity of the crate are proven for these two only.
pub trait Scalar:
    sealed::Sealed
    + nalgebra::Scalar
    + Copy
    + Default
    + PartialOrd
    + Debug
    + Display
    + LowerExp
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + Send
    + Sync
{
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;
    /// Largest finite number.
    const MAX: Self;
    /// Distance from 1 to the next number.
    const EPSILON: Self;

    /// Exact from `f32`.
    fn from_f32(value: f32) -> Self;
    /// Nearest from `f64`.
    fn from_f64(value: f64) -> Self;
    /// Exact to `f64`.
    fn to_f64(self) -> f64;
    /// `(sin, cos)` of an angle in rad.
    ///
    /// * `f32`: absolute error of either below 1e-7 for |x| < 8192 rad (1303
    ///   turns), about 40 instructions on a Cortex-M4F; both NaN beyond, where
    ///   neighbouring `f32` angles are half a milliradian apart and more.
    /// * `f64`: `libm`, below 1 ulp for every finite angle.
    fn sin_cos(self) -> (Self, Self);
    /// The same numbers by a call, where text counts more than time.
    #[inline(never)]
    fn sin_cos_once(self) -> (Self, Self) {
        self.sin_cos()
    }
    /// `(sin, cos)` of an angle that is small as a rule, by a short series up to
    /// 1/16 rad and by [`Scalar::sin_cos`] beyond: to the last bit or two.
    fn sin_cos_near_zero(self) -> (Self, Self);
    /// Angle of the point (x, `self`) from the x axis, rad; on an axis exact to the
    /// last bit. For load time, not for a tick.
    ///
    /// * `f32`: absolute error below 4e-7 rad for coordinates up to 1e38. Without meaning where
    ///   the sum of both does not fit; NaN for an infinity.
    /// * `f64`: `libm`, below 1 ulp.
    fn atan2(self, x: Self) -> Self;
    /// Square root, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;
    /// `1 - exp(-self)`, the share of a step that a lag of first order has taken
    /// after so many time constants: `libm`, below 1 ulp, near 0 as well.
    fn settled(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// The whole number next to `self`, not above it, by its low bits (two's
    /// complement), and how far `self` is beyond it: 0 to 1, both ends included, but
    /// for rounding. Without meaning from 2^22 (`f32`) or 2^51 (`f64`) on.
    fn floor_and_rest(self) -> (u32, Self);
}

impl Scalar for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MAX: Self = f32::MAX;
    const EPSILON: Self = f32::EPSILON;

    #[inline]
    fn from_f32(value: f32) -> Self {
        value
    }
    #[inline]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        single::sin_cos(self)
    }
    #[inline]
    fn sin_cos_near_zero(self) -> (Self, Self) {
        // Rest of either series below 8e-9.
        if f32::abs(self) <= 1.0 / 16.0 {
            let x2 = self * self;
            let sin = self - self * x2 * (1.0 / 6.0);
            let cos = 1.0 - x2 * (0.5 - x2 * (1.0 / 24.0));
            (sin, cos)
        } else {
            self.sin_cos_once()
        }
    }
    fn atan2(self, x: Self) -> Self {
        single::atan2(self, x)
    }
    #[inline]
    fn sqrt(self) -> Self {
        single::sqrt(self)
    }
    fn settled(self) -> Self {
        -libm::expm1f(-self)
    }
    #[inline]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
    #[inline]
    fn floor_and_rest(self) -> (u32, Self) {
        // Adding and subtracting 1.5 * 2^23 rounds to the nearest integer and
        // leaves that integer in the low bits.
        const ROUND: f32 = 12_582_912.0;
        let shifted = (self - 0.5) + ROUND;
        (shifted.to_bits(), self - (shifted - ROUND))
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MAX: Self = f64::MAX;
    const EPSILON: Self = f64::EPSILON;

    #[inline]
    fn from_f32(value: f32) -> Self {
        f64::from(value)
    }
    #[inline]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    fn sin_cos_near_zero(self) -> (Self, Self) {
        self.sin_cos()
    }
    fn atan2(self, x: Self) -> Self {
        libm::atan2(self, x)
    }
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    fn settled(self) -> Self {
        -libm::expm1(-self)
    }
    #[inline]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
    #[inline]
    fn floor_and_rest(self) -> (u32, Self) {
        // The same with 1.5 * 2^52.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        let shifted = (self - 0.5) + ROUND;
        (shifted.to_bits() as u32, self - (shifted - ROUND))
    }
}
