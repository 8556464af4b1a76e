//! The two number types of the crate and every elementary function it uses.
//!
//! All sines, cosines and square roots of the crate come from this file: from
//! `libm` or from our own polynomial, never from the platform. Together with
//! Rust's promise not to contract or reorder floating-point operations this
//! makes results bit-identical between a host and a Cortex-M.

use core::fmt::{Debug, Display, LowerExp};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

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
    /// Angle of the point (x, `self`) from the x axis, rad: `libm`. For load
    /// time, not for a tick.
    fn atan2(self, x: Self) -> Self;
    /// Square root, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
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
        sin_cos_f32(self)
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
        libm::atan2f(self, x)
    }
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }
    #[inline]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
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
    #[inline]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

/// Cody-Waite reduction to a quarter turn and minimax polynomials, in single
/// precision only: `libm::sincosf` computes in `f64`, which a Cortex-M4F does
/// in software (2,267 instructions).
fn sin_cos_f32(x: f32) -> (f32, f32) {
    // pi/2 in three parts. The first two have 8 and 11 significant bits, so
    // that quadrant * part is exact up to 8192 rad. The third is negative: an
    // infinite quadrant, see below, meets both signs here and becomes NaN.
    const HALF_PI_1: f32 = 1.570_312_5;
    const HALF_PI_2: f32 = 4.839_897_2e-4;
    const HALF_PI_3: f32 = -1.629_206_8e-7;
    // Adding and subtracting 1.5 * 2^23 rounds to the nearest integer and
    // leaves that integer in the low bits.
    const ROUND: f32 = 12_582_912.0;
    // x * 2^115 overflows from 8192 rad on; below, the scaling is exact: a
    // range check for the price of one multiplication.
    const SCALE: f32 = f32::from_bits((127 + 115) << 23);
    const TURNS: f32 = core::f32::consts::FRAC_2_PI / SCALE;

    let shifted = x * SCALE * TURNS + ROUND;
    let quadrant = shifted.to_bits();
    let turns = shifted - ROUND;
    let r = ((x - turns * HALF_PI_1) - turns * HALF_PI_2) - turns * HALF_PI_3;
    let r2 = r * r;
    // -1 for a turn by a half, the second bit of the quadrant; multiplying by
    // it costs less than negating on a condition.
    let half = f32::from_bits(1_f32.to_bits() | (quadrant & 2) << 30);
    let r = r * half;
    let sin = r + r * r2 * (-1.666_665_5e-1 + r2 * (8.332_161e-3 + r2 * -1.951_529_6e-4));
    let cos = half
        + r2 * half * (-0.5 + r2 * (4.166_664_6e-2 + r2 * (-1.388_731_6e-3 + r2 * 2.443_315_7e-5)));
    // The first bit turns by a quarter.
    if quadrant & 1 == 0 { (sin, cos) } else { (cos, -sin) }
}
