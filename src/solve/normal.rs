use core::cmp::Ordering;

use super::{Solution, SolveError, check, noise, refusal, room};
use crate::scalar::Scalar;

/// `U'U`, `U'S` and `S'S`, accumulated row by row; memory P^2.
///
/// ```
/// use truearm::solve::NormalEquations;
///
/// # fn main() -> Result<(), truearm::solve::SolveError> {
/// let mut equations = NormalEquations::<f64, 2>::new();
/// for (x, y) in [(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)] {
///     equations.push(&[1.0, x], y)?;
/// }
/// let line = equations.solve(0.0, &[1.0; 2])?;
/// assert!((line.x[0] - 1.0).abs() < 1e-12 && (line.x[1] - 2.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations<T, const P: usize> {
    /// Lower triangle of `U'U`.
    gram: [[T; P]; P],
    moment: [T; P],
    square: T,
    /// Sum of the squares of all rows and right-hand sides.
    size: T,
}

impl<T: Scalar, const P: usize> Default for NormalEquations<T, P> {
    fn default() -> Self {
        Self { gram: [[T::ZERO; P]; P], moment: [T::ZERO; P], square: T::ZERO, size: T::ZERO }
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
    ///
    /// # Errors
    /// [`SolveError::NotFinite`] for a value that is none, [`SolveError::Overflow`]
    /// where the squares of all rows have a sum that does not fit; nothing has been
    /// added then.
    pub fn push(&mut self, row: &[T; P], rhs: T) -> Result<(), SolveError> {
        let size = row.iter().fold(self.size + rhs * rhs, |sum, a| sum + *a * *a);
        if size.partial_cmp(&room()).is_none_or(Ordering::is_gt) {
            return Err(refusal(row.iter().chain([&rhs]), true));
        }
        self.size = size;
        for (i, ((gram, moment), a)) in
            self.gram.iter_mut().zip(&mut self.moment).zip(row).enumerate()
        {
            for (gram, b) in gram.iter_mut().zip(row).take(i + 1) {
                *gram += *a * *b;
            }
            *moment += *a * rhs;
        }
        self.square += rhs * rhs;
        Ok(())
    }

    /// Minimises `|U x - S|^2 + lambda |x / scale|^2` by square-root-free
    /// Cholesky; P^3/6 multiply-adds. An infinite scale leaves a parameter free of
    /// the penalty.
    ///
    /// A pivot below `16 P EPSILON` of its diagonal carries no information; the
    /// direction is dropped and counted. `residual_square` is formed by
    /// cancellation and good to about `EPSILON * S'S`.
    ///
    /// # Errors
    /// A negative lambda, a scale that is not positive, or an overflow.
    pub fn solve(&self, lambda: T, scale: &[T; P]) -> Result<Solution<T, P>, SolveError> {
        check(lambda, scale)?;
        // Scaling rows and columns would change no pivot's share of its diagonal.
        let mut l = self.gram;
        for (k, (row, scale)) in l.iter_mut().zip(scale).enumerate() {
            if let Some(diagonal) = row.get_mut(k) {
                let penalty = T::ONE / *scale;
                *diagonal += lambda * penalty * penalty;
            }
        }
        let mut x = self.moment;
        let dropped = factorise_and_solve(&mut l, &mut x);
        let residual_square = self.residual_square(&x);
        Solution::of(x, residual_square, lambda, scale, dropped)
    }

    fn residual_square(&self, x: &[T; P]) -> T {
        let two = T::ONE + T::ONE;
        let mut sum = self.square;
        for (i, ((gram, moment), own)) in self.gram.iter().zip(&self.moment).zip(x).enumerate() {
            // The lower triangle twice but for its diagonal.
            let mut part = -(two * *moment);
            for (j, (gram, other)) in gram.iter().zip(x).take(i + 1).enumerate() {
                part += if j < i { two * *gram * *other } else { *gram * *other };
            }
            sum += *own * part;
        }
        // Not by a comparison that makes zero of what is no number.
        if sum < T::ZERO { T::ZERO } else { sum }
    }
}

/// `L D L'` in place of the lower triangle, L below the diagonal and 1 / D on it
/// (0 for a dropped direction), and the solution in place of `x`; how many
/// directions were dropped.
fn factorise_and_solve<T: Scalar, const P: usize>(l: &mut [[T; P]; P], x: &mut [T; P]) -> usize {
    let tolerance = noise::<T, P>();
    let mut dropped = 0;
    for i in 0..P {
        let Some((done, rest)) = l.split_at_mut_checked(i) else { break };
        let Some(row) = rest.first_mut() else { break };
        // L D first, one element after the other.
        for (j, other) in done.iter().enumerate() {
            let known = row.iter().zip(other).take(j);
            let sum = known.fold(T::ZERO, |sum, (a, b)| sum + *a * *b);
            if let Some(element) = row.get_mut(j) {
                *element -= sum;
            }
        }
        let mut taken = T::ZERO;
        for (j, (element, other)) in row.iter_mut().zip(done.iter()).enumerate() {
            let inverse = other.get(j).copied().unwrap_or(T::ZERO);
            let scaled = *element * inverse;
            taken += *element * scaled;
            *element = scaled;
        }
        if let Some(diagonal) = row.get_mut(i) {
            let pivot = *diagonal - taken;
            let kept = pivot > tolerance * *diagonal;
            dropped += usize::from(!kept);
            *diagonal = if kept { T::ONE / pivot } else { T::ZERO };
        }
        // Forward substitution of this row.
        let sum = row.iter().zip(x.iter()).take(i).fold(T::ZERO, |sum, (l, y)| sum + *l * *y);
        if let Some(y) = x.get_mut(i) {
            *y -= sum;
        }
    }
    for (k, (x, row)) in x.iter_mut().zip(l.iter()).enumerate() {
        *x *= row.get(k).copied().unwrap_or(T::ZERO);
    }
    for (row, i) in l.iter().rev().zip((0..P).rev()) {
        // Final: the rows below have taken theirs. A dropped one has a column of zeros.
        let own = x.get(i).copied().unwrap_or(T::ZERO);
        for (x, l) in x.iter_mut().zip(row).take(i) {
            *x -= *l * own;
        }
    }
    dropped
}
