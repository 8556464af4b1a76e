use super::{Solution, SolveError, check};
use crate::scalar::Scalar;

/// The upper triangle `R` of `U = QR`, `Q'S`, and what of `S` lies outside;
/// memory P^2, whatever the number of rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle<T, const P: usize> {
    r: [[T; P]; P],
    c: [T; P],
    outside: T,
}

impl<T: Scalar, const P: usize> Default for Triangle<T, P> {
    fn default() -> Self {
        Self { r: [[T::ZERO; P]; P], c: [T::ZERO; P], outside: T::ZERO }
    }
}

impl<T: Scalar, const P: usize> Triangle<T, P> {
    /// No rows yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Folds M equations `row . x = rhs` in by Householder reflections;
    /// about `M P (P + 1) + P^2` multiply-adds and P square roots. One
    /// tracker point is M = 3.
    pub fn push<const M: usize>(&mut self, mut rows: [[T; P]; M], mut rhs: [T; M]) {
        for k in 0..P {
            let mut below = T::ZERO;
            for row in &rows {
                below += row[k] * row[k];
            }
            if below == T::ZERO {
                continue;
            }
            let pivot = self.r[k][k];
            let norm = (pivot * pivot + below).sqrt();
            let norm = if pivot > T::ZERO { -norm } else { norm };
            // Reflection I - v v' / h with v = (head, rows[..][k]).
            let head = pivot - norm;
            let inverse = -T::ONE / (norm * head);
            self.r[k][k] = norm;
            for j in k + 1..P {
                let mut product = head * self.r[k][j];
                for row in &rows {
                    product += row[k] * row[j];
                }
                product *= inverse;
                self.r[k][j] -= product * head;
                for row in &mut rows {
                    let step = product * row[k];
                    row[j] -= step;
                }
            }
            let mut product = head * self.c[k];
            for (row, s) in rows.iter().zip(&rhs) {
                product += row[k] * *s;
            }
            product *= inverse;
            self.c[k] -= product * head;
            for (row, s) in rows.iter().zip(&mut rhs) {
                *s -= product * row[k];
            }
        }
        for s in rhs {
            self.outside += s * s;
        }
    }

    /// Minimises `|U x - S|^2 + lambda |x / scale|^2`: appends
    /// `sqrt(lambda) I` to the scaled triangle and reflects again, so that the
    /// condition number is never squared.
    ///
    /// A diagonal below `16 P EPSILON` of its column's length carries no information;
    /// its unknown is zero and counted in `dropped`.
    ///
    /// # Errors
    /// A negative lambda, a scale that is not positive, or rows that were not
    /// finite.
    pub fn solve(&self, lambda: T, scale: &[T; P]) -> Result<Solution<T, P>, SolveError> {
        check(lambda, scale)?;
        let mut augmented = *self;
        for row in &mut augmented.r {
            for (r, s) in row.iter_mut().zip(scale) {
                *r *= *s;
            }
        }
        let scaled = augmented;
        if lambda > T::ZERO {
            for k in 0..P {
                let mut row = [T::ZERO; P];
                row[k] = lambda.sqrt();
                augmented.push([row], [T::ZERO]);
            }
        }
        let tolerance = super::noise::<T, P>();
        let mut y = augmented.c;
        let mut dropped = 0;
        for i in (0..P).rev() {
            for j in i + 1..P {
                let step = augmented.r[i][j] * y[j];
                y[i] -= step;
            }
            let mut column = T::ZERO;
            for k in 0..=i {
                column += augmented.r[k][i] * augmented.r[k][i];
            }
            if augmented.r[i][i].abs() > tolerance * column.sqrt() {
                y[i] /= augmented.r[i][i];
            } else {
                y[i] = T::ZERO;
                dropped += 1;
            }
        }
        let (mut residual_square, mut norm_square) = (self.outside, T::ZERO);
        let mut x = y;
        for i in 0..P {
            let mut rest = -self.c[i];
            for j in i..P {
                rest += scaled.r[i][j] * y[j];
            }
            residual_square += rest * rest;
            norm_square += y[i] * y[i];
            x[i] *= scale[i];
        }
        if !(residual_square.is_finite() && norm_square.is_finite()) {
            return Err(SolveError::NotFinite);
        }
        Ok(Solution { x, residual_square, norm_square, lambda, dropped })
    }
}
