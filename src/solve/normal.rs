use super::{Solution, SolveError, check};
use crate::scalar::Scalar;

/// `U'U`, `U'S` and `S'S`, accumulated row by row; memory P^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations<T, const P: usize> {
    /// Lower triangle of `U'U`.
    gram: [[T; P]; P],
    moment: [T; P],
    square: T,
}

impl<T: Scalar, const P: usize> Default for NormalEquations<T, P> {
    fn default() -> Self {
        Self { gram: [[T::ZERO; P]; P], moment: [T::ZERO; P], square: T::ZERO }
    }
}

impl<T: Scalar, const P: usize> NormalEquations<T, P> {
    /// No rows yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the equation `row . x = rhs`; P^2/2 multiply-adds. Divide both by
    /// the standard deviation of `rhs` to weight.
    pub fn push(&mut self, row: &[T; P], rhs: T) {
        for i in 0..P {
            for j in 0..=i {
                self.gram[i][j] += row[i] * row[j];
            }
            self.moment[i] += row[i] * rhs;
        }
        self.square += rhs * rhs;
    }

    /// Minimises `|U x - S|^2 + lambda |x / scale|^2` by square-root-free
    /// Cholesky of the scaled equations; P^3/6 multiply-adds.
    ///
    /// A pivot below `16 P EPSILON` of its diagonal carries no information; the
    /// direction is dropped and counted. `residual_square` is formed by
    /// cancellation and good to about `EPSILON * S'S`.
    ///
    /// # Errors
    /// A negative lambda, a scale that is not positive, or rows that were not
    /// finite.
    pub fn solve(&self, lambda: T, scale: &[T; P]) -> Result<Solution<T, P>, SolveError> {
        check(lambda, scale)?;
        // L below the diagonal, D on it.
        let mut l = self.gram;
        let mut y = self.moment;
        let mut dropped = 0;
        let tolerance = super::noise::<T, P>();
        let mut inverse = [T::ZERO; P];
        for i in 0..P {
            for j in 0..=i {
                l[i][j] = l[i][j] * scale[i] * scale[j];
            }
            l[i][i] += lambda;
            y[i] *= scale[i];
        }
        for i in 0..P {
            let diagonal = l[i][i];
            for j in 0..i {
                let mut sum = l[i][j];
                for k in 0..j {
                    sum -= l[i][k] * l[j][k] * l[k][k];
                }
                l[i][j] = sum * inverse[j];
            }
            let mut pivot = diagonal;
            for k in 0..i {
                pivot -= l[i][k] * l[i][k] * l[k][k];
            }
            l[i][i] = pivot;
            if pivot > tolerance * diagonal {
                inverse[i] = T::ONE / pivot;
            } else {
                dropped += 1;
                l[i][i] = T::ZERO;
            }
        }
        for i in 0..P {
            for k in 0..i {
                let step = l[i][k] * y[k];
                y[i] -= step;
            }
        }
        for i in (0..P).rev() {
            y[i] *= inverse[i];
            // For a dropped direction the column is zero: y stays zero.
            for k in i + 1..P {
                let step = l[k][i] * y[k];
                y[i] -= step;
            }
        }
        let mut x = y;
        let mut norm_square = T::ZERO;
        for i in 0..P {
            x[i] *= scale[i];
            norm_square += y[i] * y[i];
        }
        let mut residual_square = self.square;
        for i in 0..P {
            let mut gram_x = T::ZERO;
            for j in 0..P {
                gram_x += (if j <= i { self.gram[i][j] } else { self.gram[j][i] }) * x[j];
            }
            residual_square += x[i] * (gram_x - self.moment[i] - self.moment[i]);
        }
        if residual_square < T::ZERO {
            residual_square = T::ZERO;
        }
        if !(residual_square.is_finite() && norm_square.is_finite()) {
            return Err(SolveError::NotFinite);
        }
        Ok(Solution { x, residual_square, norm_square, lambda, dropped })
    }
}
