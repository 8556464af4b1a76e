//! Fixed-size regularised least squares for controllers without a heap.
//!
//! Both solvers take one row `u . x = s` at a time and minimise
//! `|U x - S|^2 + lambda |x / scale|^2` (paper Eq. 11, with a scale for every
//! parameter). Setting the derivative to zero gives
//! `(U'U + lambda D) x = U'S` with `D = diag(1 / scale^2)`. Eq. 14 of the paper
//! prints the last term as `2 (lambda I)' lambda I`, without the unknown and
//! with lambda squared; it must read `2 lambda x`.
//!
//! * [`NormalEquations`] squares the condition number: cheap, good to a
//!   condition of about `EPSILON^-1/2` (or any, with enough lambda).
//! * [`Triangle`] keeps the QR factor by square-root-free rotations: for the
//!   ill-conditioned case.
//! * [`Spectrum`] is a triangle factorised for every lambda: norms, L-curve
//!   and its corner.
//! * [`StreamingTikhonov`] holds points back to judge lambda by, and
//!   [`most_parameters`] says what fits a controller.
//! * [`Misfit`] says whether a fit agrees with the noise that was stated.

mod memory;
mod misfit;
mod normal;
mod spectrum;
mod streaming;
mod triangle;
mod turn;

use core::cmp::Ordering;

use crate::scalar::Scalar;

pub use memory::{Memory, most_parameters};
pub use misfit::Misfit;
pub use normal::NormalEquations;
pub use spectrum::Spectrum;
pub use streaming::{LambdaChoice, StreamingTikhonov};
pub use triangle::Triangle;

/// What a solve returned and what it did to get there.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Solution<T, const P: usize> {
    /// The solution, in the units of the columns.
    pub x: [T; P],
    /// `|U x - S|^2`.
    pub residual_square: T,
    /// `|x / scale|^2`.
    pub norm_square: T,
    /// The lambda used.
    pub lambda: T,
    /// Directions without information at working precision: their unknown was
    /// set to zero instead of dividing by rounding noise.
    pub dropped: usize,
}

impl<T: Scalar, const P: usize> Solution<T, P> {
    /// With its norm in scaled units; an error where a figure of it is not finite.
    fn of(
        x: [T; P],
        residual_square: T,
        lambda: T,
        scale: &[T; P],
        dropped: usize,
    ) -> Result<Self, SolveError> {
        let mut norm_square = T::ZERO;
        for (x, scale) in x.iter().zip(scale) {
            norm_square += (*x / *scale) * (*x / *scale);
        }
        if !(residual_square.is_finite() && norm_square.is_finite()) {
            return Err(SolveError::NotFinite);
        }
        Ok(Self { x, residual_square, norm_square, lambda, dropped })
    }
}

/// Why a solve gave no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SolveError {
    /// Lambda is negative or not a number.
    BadLambda,
    /// The scale of this parameter is not a positive number.
    BadScale {
        /// 0-based index of the parameter.
        parameter: usize,
    },
    /// A row or the result holds an infinity or a NaN.
    NotFinite,
    /// The squares of all rows have a sum beyond what this type of number can
    /// work with: 1e30 in `f32`, 1e300 in `f64`.
    Overflow,
    /// The forgetting factor is not in (0, 1], or so small that its inverse overflows.
    BadForgetting,
}

impl core::fmt::Display for SolveError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::BadLambda => f.write_str("lambda must be zero or positive"),
            Self::BadScale { parameter } => {
                write!(f, "the scale of parameter {} must be positive", parameter + 1)
            }
            Self::NotFinite => f.write_str("a measurement or the result is not finite"),
            Self::Overflow => {
                f.write_str("the measurements are too large to be squared and summed")
            }
            Self::BadForgetting => f.write_str("the forgetting factor must be above 0, at most 1"),
        }
    }
}

impl core::error::Error for SolveError {}

fn check<T: Scalar, const P: usize>(lambda: T, scale: &[T; P]) -> Result<(), SolveError> {
    if !(lambda >= T::ZERO && lambda.is_finite()) {
        return Err(SolveError::BadLambda);
    }
    // An infinite scale is a parameter without penalty.
    match scale.iter().position(|s| s.partial_cmp(&T::ZERO) != Some(Ordering::Greater)) {
        Some(parameter) => Err(SolveError::BadScale { parameter }),
        None => Ok(()),
    }
}

/// Most that squares may sum up to. Products of two numbers that such a sum and
/// the least weights bound still fit.
fn room<T: Scalar>() -> T {
    T::MAX * T::from_f32(1e-8)
}

/// Why a row was refused: of finite numbers and a good weight it was too large.
#[cold]
fn refusal<'a, T: Scalar>(mut row: impl Iterator<Item = &'a T>, good_weight: bool) -> SolveError {
    if good_weight && row.all(|v| v.is_finite()) {
        SolveError::Overflow
    } else {
        SolveError::NotFinite
    }
}

/// Relative size below which a pivot is rounding noise.
fn noise<T: Scalar, const P: usize>() -> T {
    T::EPSILON * T::from_f32(16.0 * P as f32)
}
