//! A vector of numbers that is added and multiplied like one.

use core::ops::{Add, Mul, Sub};

use pulp::Simd;

use crate::lanes::Lanes;

/// As many numbers as the instructions `S` compute at once.
pub struct Wide<T: Lanes, S: Simd> {
    pub simd: S,
    pub value: T::Vector<S>,
}

impl<T: Lanes, S: Simd> Clone for Wide<T, S> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Lanes, S: Simd> Copy for Wide<T, S> {}

impl<T: Lanes, S: Simd> Wide<T, S> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: T) -> Self {
        Self { simd, value: T::splat(simd, value) }
    }

    /// Sine and cosine of every lane.
    #[inline(always)]
    pub fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = T::turn(self.simd, self.value);
        (self.with(sin), self.with(cos))
    }

    #[inline(always)]
    pub fn with(self, value: T::Vector<S>) -> Self {
        Self { value, ..self }
    }
}

// Never `mul_add`: fused products have other bits, and not every processor has them.

impl<T: Lanes, S: Simd> Add for Wide<T, S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(T::sum(self.simd, self.value, other.value))
    }
}

impl<T: Lanes, S: Simd> Sub for Wide<T, S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(T::difference(self.simd, self.value, other.value))
    }
}

impl<T: Lanes, S: Simd> Mul for Wide<T, S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(T::product(self.simd, self.value, other.value))
    }
}

impl<T: Lanes, S: Simd> Add<T> for Wide<T, S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: T) -> Self {
        self + Self::splat(self.simd, other)
    }
}

impl<T: Lanes, S: Simd> Sub<T> for Wide<T, S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: T) -> Self {
        self - Self::splat(self.simd, other)
    }
}

impl<T: Lanes, S: Simd> Mul<T> for Wide<T, S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: T) -> Self {
        self * Self::splat(self.simd, other)
    }
}
