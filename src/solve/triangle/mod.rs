mod answers;

use super::turn::{TINY, Turn, turn_far};
use super::{SolveError, refusal, room};
use crate::scalar::Scalar;

/// The triangular factor of all rows seen so far, in square-root-free form:
/// `R = D^(1/2) U` with a unit diagonal, `Q'S = D^(1/2) c`, and what of `S` no
/// solution reaches. Memory `P^2 + 3 P + 2` numbers, whatever the number of rows.
///
/// Rows are folded in by Gentleman's square-root-free Givens rotations (W. M.
/// Gentleman, *Least squares computations by Givens transformations without
/// square roots*, IMA J. Appl. Math. 12, 1973), M rows in one pass: 4 M
/// operations an element against 4 M + 6 of a Householder reflection, and no
/// root. Where a rotation turns by more than 45 degrees the two-multiplication
/// form would cancel, and the weight of what is left of the row could underflow
/// while its elements overflow; there row and pivot change roles, at two
/// multiplications more. No weight then falls below half of the least of the row's
/// and the pivots', and nothing overflows as long as the squares of all rows have a
/// sum that fits: see [`SolveError::Overflow`].
///
/// ```
/// use truearm::solve::Triangle;
///
/// # fn main() -> Result<(), truearm::solve::SolveError> {
/// let mut triangle = Triangle::<f64, 2>::new();
/// for (x, y) in [(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)] {
///     // A column a parameter; here of one equation.
///     triangle.push(&[[1.0], [x]], &[y])?;
/// }
/// let line = triangle.solve(0.0, &[1.0; 2])?;
/// assert!((line.x[0] - 1.0).abs() < 1e-12 && (line.x[1] - 2.0).abs() < 1e-12);
/// // The same for any lambda, with norms and the corner of the L-curve.
/// assert_eq!(triangle.spectrum(&[1.0; 2])?.rank(), 2);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle<T, const P: usize> {
    /// Row k from the first element right of its diagonal: `U[k][k + 1 + i]`.
    pub(super) u: [[T; P]; P],
    pub(super) d: [T; P],
    pub(super) c: [T; P],
    /// Squared length of each column, which no rotation changes: tells a pivot
    /// from the rounding noise of a dependent column.
    length: [T; P],
    pub(super) outside: T,
    /// Sum of the squares of all rows and right-hand sides: bounds every number above.
    size: T,
}

impl<T: Scalar, const P: usize> Default for Triangle<T, P> {
    fn default() -> Self {
        let none = [T::ZERO; P];
        Self { u: [none; P], d: none, c: none, length: none, outside: T::ZERO, size: T::ZERO }
    }
}

impl<T: Scalar, const P: usize> Triangle<T, P> {
    /// No rows yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets all rows, in place.
    pub fn clear(&mut self) {
        let rows = self.u.iter_mut().flatten().chain(&mut self.d).chain(&mut self.c);
        let all = rows.chain(&mut self.length).chain([&mut self.outside, &mut self.size]);
        all.for_each(|value| *value = T::ZERO);
    }

    /// Folds M equations `sum_k columns[k][m] x[k] = rhs[m]` in, given as the
    /// Jacobian gives them, a column a parameter; about `2 M P^2` operations.
    /// A tracker point is M = 3, a distance or a ballbar length M = 1. Divide
    /// both sides by the standard deviation of `rhs` to weight.
    ///
    /// # Errors
    /// [`SolveError::NotFinite`] for a value that is none, [`SolveError::Overflow`]
    /// where the squares of all rows have a sum that does not fit; the triangle is
    /// then unchanged.
    #[inline]
    pub fn push<const M: usize>(
        &mut self,
        columns: &[[T; M]; P],
        rhs: &[T; M],
    ) -> Result<(), SolveError> {
        self.push_weighted(columns, rhs, T::ONE)
    }

    /// The same with a weight, `1 / sigma^2`.
    ///
    /// # Errors
    /// As for [`Self::push`]; also [`SolveError::NotFinite`] for a weight that is
    /// negative or not finite.
    #[inline]
    pub fn push_weighted<const M: usize>(
        &mut self,
        columns: &[[T; M]; P],
        rhs: &[T; M],
        weight: T,
    ) -> Result<(), SolveError> {
        let squares = columns.each_ref().map(square);
        let sum = squares.iter().fold(square(rhs), |sum, s| sum + *s);
        let size = self.size + weight * sum;
        if !(size <= room() && weight >= T::ZERO) {
            let all = columns.as_flattened().iter().chain(rhs);
            return Err(refusal(all.chain([&weight]), weight >= T::ZERO));
        }
        self.size = size;
        for (length, square) in self.length.iter_mut().zip(&squares) {
            *length += weight * *square;
        }
        self.fold(*columns, *rhs, [weight; M]);
        Ok(())
    }

    /// Two pivots in one pass: each element of the rows is loaded once for both.
    fn fold<const M: usize>(
        &mut self,
        mut columns: [[T; M]; P],
        mut rhs: [T; M],
        mut weights: [T; M],
    ) {
        let (us, last_u) = self.u.as_chunks_mut::<2>();
        let (ds, last_d) = self.d.as_chunks_mut::<2>();
        let (cs, last_c) = self.c.as_chunks_mut::<2>();
        let mut rest = columns.as_mut_slice();
        for (([u, v], [du, dv]), [cu, cv]) in us.iter_mut().zip(ds).zip(cs) {
            let ([x, behind @ ..], [head, tail_u @ ..]) = (rest, u.as_mut_slice()) else { return };
            let [y, ..] = behind else { return };
            let first = Turn::new(*du, &weights, x);
            let (mut turned_head, mut turned_y) = (*head, *y);
            first.apply(&mut turned_head, &mut turned_y);
            let second = Turn::new(*dv, &first.weights, &turned_y);
            if first.gentle && second.gentle {
                (*head, *du, *dv, weights) = (turned_head, first.d, second.d, second.weights);
                first.apply(cu, &mut rhs);
                second.apply(cv, &mut rhs);
                let [_, tail @ ..] = behind else { return };
                for ((u, v), a) in tail_u.iter_mut().zip(v.iter_mut()).zip(tail.iter_mut()) {
                    first.apply(u, a);
                    second.apply(v, a);
                }
                rest = tail;
            } else {
                turn_far(du, (u, cu), x, (behind, &mut rhs), &mut weights);
                let [y, tail @ ..] = behind else { return };
                turn_far(dv, (v, cv), y, (tail, &mut rhs), &mut weights);
                rest = tail;
            }
        }
        if let ([u], [d], [c], [x]) = (last_u, last_d, last_c, rest) {
            turn_far(d, (u, c), x, (&mut [], &mut rhs), &mut weights);
        }
        for (s, weight) in rhs.iter().zip(&weights) {
            self.outside += *weight * *s * *s;
        }
    }

    /// Folds in all rows that another triangle has seen.
    ///
    /// # Errors
    /// [`SolveError::Overflow`]; the triangle is then unchanged.
    pub fn absorb(&mut self, other: &Self) -> Result<(), SolveError> {
        let size = self.size + other.size;
        if size > room() {
            return Err(SolveError::Overflow);
        }
        self.size = size;
        for (length, of_other) in self.length.iter_mut().zip(&other.length) {
            *length += *of_other;
        }
        for (k, ((u, d), c)) in other.u.iter().zip(&other.d).zip(&other.c).enumerate() {
            let mut columns = [[T::ZERO]; P];
            let right = core::iter::once(T::ONE).chain(u.iter().copied());
            for (column, u) in columns.iter_mut().skip(k).zip(right) {
                *column = [u];
            }
            self.fold(columns, [*c], [*d]);
        }
        self.outside += other.outside;
        Ok(())
    }

    /// Weighs everything seen so far by `factor`, between 0 and 1: with one
    /// factor before each point, old points fade exponentially. Any other one,
    /// also NaN, forgets nothing. `3 P` operations.
    pub fn forget(&mut self, factor: T) {
        if !(factor >= T::ZERO && factor <= T::ONE) {
            return;
        }
        for value in self.d.iter_mut().chain(&mut self.length) {
            *value *= factor;
            if *value < T::from_f32(TINY) {
                *value = T::ZERO;
            }
        }
        self.outside *= factor;
        self.size *= factor;
    }
}

fn square<T: Scalar, const M: usize>(values: &[T; M]) -> T {
    values.iter().fold(T::ZERO, |sum, v| sum + *v * *v)
}
