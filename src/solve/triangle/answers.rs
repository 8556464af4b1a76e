//! What a triangle tells of the rows it has seen: solutions, residuals, variances.

use super::Triangle;
use crate::scalar::Scalar;
use crate::solve::{Solution, SolveError, check, noise};

impl<T: Scalar, const P: usize> Triangle<T, P> {
    /// `|U x - S|^2` for any `x`: rows of one triangle judge the solution of
    /// another.
    #[must_use]
    pub fn residual_square(&self, x: &[T; P]) -> T {
        let mut sum = self.outside;
        for (k, (((u, d), c), own)) in self.u.iter().zip(&self.d).zip(&self.c).zip(x).enumerate() {
            let mut rest = *c - *own;
            for (u, x) in u.iter().zip(x.get(k + 1..).unwrap_or_default()) {
                rest -= *u * *x;
            }
            sum += *d * rest * rest;
        }
        sum
    }

    /// `|S|^2` less the residual of the least-squares solution: how much of the
    /// right-hand side the columns explain.
    #[must_use]
    pub fn explained_square(&self) -> T {
        self.d.iter().zip(&self.c).fold(T::ZERO, |sum, (d, c)| sum + *d * *c * *c)
    }

    /// The same under the penalty `lambda |x / scale|^2`: `|S|^2` less the least of
    /// residual and penalty together. About `2/3 P^3` operations.
    ///
    /// # Errors
    /// As for [`Self::solve`].
    pub fn explained_square_with(&self, lambda: T, scale: &[T; P]) -> Result<T, SolveError> {
        let mut augmented = *self;
        augmented.penalise(lambda, scale)?;
        Ok(augmented.explained_square())
    }

    /// The right-hand side's `|S|^2`.
    #[must_use]
    pub fn total_square(&self) -> T {
        self.outside + self.explained_square()
    }

    /// Whether the data say nothing of a parameter beyond those before it: its
    /// pivot is below `16 P EPSILON` of its column's length.
    pub(in crate::solve) fn is_dropped(&self, parameter: usize) -> bool {
        let of = |values: &[T; P]| values.get(parameter).copied().unwrap_or(T::ZERO);
        let threshold = noise::<T, P>() * noise::<T, P>();
        // Not `<=`: what is not a number is not dropped silently.
        of(&self.d) == T::ZERO || of(&self.d) < threshold * of(&self.length)
    }

    /// Minimises `|U x - S|^2 + lambda |x / scale|^2`: folds the rows
    /// `sqrt(lambda) / scale` into a copy of the triangle, so that the condition
    /// number is never squared. An infinite scale leaves a parameter free of
    /// the penalty. About `2/3 P^3` operations and `P^2` numbers of stack.
    ///
    /// A parameter without information at working precision is zero and
    /// counted in `dropped`; with lambda = 0 as much as one row may be lost
    /// with each.
    ///
    /// # Errors
    /// A negative lambda, a scale that is not positive, or an overflow.
    pub fn solve(&self, lambda: T, scale: &[T; P]) -> Result<Solution<T, P>, SolveError> {
        let mut augmented = *self;
        augmented.penalise(lambda, scale)?;
        let mut x = augmented.c;
        let dropped = augmented.back_substitute(&mut x);
        let residual_square = self.residual_square(&x);
        Solution::of(x, residual_square, lambda, scale, dropped)
    }

    /// Variance of each parameter of [`Self::solve`] for rows of unit noise:
    /// the diagonal of `(U'U + lambda diag(1 / scale^2))^-1`, by columns of the
    /// inverse triangle; about `P^3 / 3` operations, `P^2` numbers of stack.
    /// Infinite for a parameter without information.
    ///
    /// # Errors
    /// As for [`Self::solve`].
    pub fn variances(&self, lambda: T, scale: &[T; P]) -> Result<[T; P], SolveError> {
        let mut augmented = *self;
        augmented.penalise(lambda, scale)?;
        let mut variances = [T::ZERO; P];
        for (j, d) in augmented.d.iter().enumerate() {
            if augmented.is_dropped(j) {
                if let Some(variance) = variances.get_mut(j) {
                    *variance = T::ONE / T::ZERO;
                }
                continue;
            }
            let mut z = [T::ZERO; P];
            if let Some(z) = z.get_mut(j) {
                *z = T::ONE;
            }
            augmented.back_substitute(&mut z);
            for (variance, z) in variances.iter_mut().zip(&z) {
                *variance += *z * *z / *d;
            }
        }
        Ok(variances)
    }

    /// Folds the rows `sqrt(lambda) / scale` in.
    #[inline(never)]
    fn penalise(&mut self, lambda: T, scale: &[T; P]) -> Result<(), SolveError> {
        check(lambda, scale)?;
        if lambda > T::ZERO {
            for (k, scale) in scale.iter().enumerate().filter(|(_, s)| s.is_finite()) {
                let mut columns = [[T::ZERO]; P];
                if let Some(column) = columns.get_mut(k) {
                    *column = [T::ONE / *scale];
                }
                self.push_weighted(&columns, &[T::ZERO], lambda)?;
            }
        }
        Ok(())
    }

    /// Solves `U x = x` in place, parameters without information zero; returns
    /// how many these are.
    pub(in crate::solve) fn back_substitute(&self, x: &mut [T; P]) -> usize {
        let mut dropped = 0;
        for (u, k) in self.u.iter().rev().zip((0..P).rev()) {
            let mut value = x.get(k).copied().unwrap_or(T::ZERO);
            for (u, x) in u.iter().zip(x.get(k + 1..).unwrap_or_default()) {
                value -= *u * *x;
            }
            if self.is_dropped(k) {
                value = T::ZERO;
                dropped += 1;
            }
            if let Some(x) = x.get_mut(k) {
                *x = value;
            }
        }
        dropped
    }
}
