//! Triangular systems and Cholesky factors by blocks: products of whole matrices
//! take a fifth of the time of one column after the other. The order of every sum
//! depends on the sizes alone, so that results have the same bits on any number of
//! threads.

use nalgebra::{Cholesky, DMatrix, DMatrixView, DMatrixViewMut, Dyn};
use rayon::prelude::*;

/// Unknowns that are solved for one after the other.
const FEW: usize = 48;
/// Columns of a factor that are eliminated together.
const PANEL: usize = 96;
/// Right-hand sides of one task.
const TASK: usize = 2 * PANEL;

/// Solves `L X = B` in place, L the lower triangle of a square matrix with a
/// positive diagonal; what stands above it is not looked at.
pub fn solve_lower(l: &DMatrix<f64>, b: &mut DMatrix<f64>) {
    let rows = b.nrows();
    if rows == 0 {
        return;
    }
    let inverses = Inverses::of(l);
    let columns = b.as_mut_slice().par_chunks_mut(rows * TASK);
    columns.for_each(|some| {
        let width = some.len() / rows;
        let mut some = DMatrixViewMut::from_slice(some, rows, width);
        inverses.halves(&l.as_view(), 0, &mut some.rows_mut(0, rows));
    });
}

/// The inverse of the lower triangle of a square matrix with a positive diagonal.
#[must_use]
pub fn inverse_lower(l: &DMatrix<f64>) -> DMatrix<f64> {
    let n = l.nrows();
    let mut inverse = DMatrix::identity(n, n);
    if n == 0 {
        return inverse;
    }
    let inverses = Inverses::of(l);
    let columns = inverse.as_mut_slice().par_chunks_mut(n * TASK).enumerate();
    columns.for_each(|(k, some)| {
        // Above its diagonal it is nothing.
        let (first, width) = (k * TASK, some.len() / n);
        let mut some = DMatrixViewMut::from_slice(some, n, width);
        let below = n - first;
        let own = l.view((first, first), (below, below));
        inverses.halves(&own, first / FEW, &mut some.rows_mut(first, below));
    });
    inverse
}

/// Inverses of the blocks on a triangle's diagonal: a product with one takes a third of the
/// time of solving for its unknowns one after the other, and errs by the condition of a block
/// at most (a test has blocks that are singular but for a millionth).
struct Inverses(Vec<DMatrix<f64>>);

impl Inverses {
    fn of(l: &DMatrix<f64>) -> Self {
        let n = l.nrows();
        let inverse = |first: usize| {
            let few = FEW.min(n - first);
            let mut out = DMatrix::identity(few, few);
            let _ = l.view((first, first), (few, few)).solve_lower_triangular_mut(&mut out);
            out
        };
        Self((0..n).step_by(FEW).map(inverse).collect())
    }

    /// The first half of the unknowns, what they explain, the second half; of a triangle whose
    /// first block is this one.
    fn halves(&self, l: &DMatrixView<f64>, block: usize, b: &mut DMatrixViewMut<f64>) {
        let n = l.nrows();
        if n <= FEW {
            let right = b.clone_owned();
            b.gemm(1.0, &self.0[block], &right, 0.0);
            return;
        }
        // A multiple of what is solved at a time, so that halves are whole blocks; less than n.
        let first = (n / 2).next_multiple_of(FEW);
        self.halves(&l.view((0, 0), (first, first)), block, &mut b.rows_mut(0, first));
        let (known, mut rest) = b.rows_range_pair_mut(0..first, first..n);
        rest.gemm(-1.0, &l.view((first, 0), (n - first, first)), &known, 1.0);
        let below = l.view((first, first), (n - first, n - first));
        self.halves(&below, block + first / FEW, &mut rest);
    }
}

/// Cholesky factor of a symmetric matrix, of which the lower triangle is read;
/// `None` where it is not positive definite.
#[must_use]
pub fn cholesky(mut a: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let n = a.nrows();
    for first in (0..n).step_by(PANEL) {
        let width = PANEL.min(n - first);
        let below = n - first - width;
        let own = a.view((first, first), (width, width)).into_owned().cholesky()?.unpack();
        a.view_mut((first, first), (width, width)).copy_from(&own);
        if below == 0 {
            break;
        }
        // A21 = L21 L11': L11 L21' = A21'.
        let mut across = a.view((first + width, first), (below, width)).transpose();
        solve_lower(&own, &mut across);
        let down = across.transpose();
        a.view_mut((first + width, first), (below, width)).copy_from(&down);
        let rest = first + width;
        let panels = a.as_mut_slice()[rest * n..].par_chunks_mut(PANEL * n).enumerate();
        panels.for_each(|(k, panel)| {
            let (block, wide) = (k * PANEL, panel.len() / n);
            let mut panel = DMatrixViewMut::from_slice(panel, n, wide);
            let mut target = panel.rows_mut(rest + block, below - block);
            let across = across.columns(block, wide);
            target.gemm(-1.0, &down.rows(block, below - block), &across, 1.0);
        });
    }
    Some(Cholesky::pack_dirty(a))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// At every size about those at which blocks begin and end.
    #[test]
    fn blocks_give_what_columns_give() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for n in [0, 1, 2, 47, 48, 49, 95, 96, 97, 143, 145, 192, 193, 300] {
            let root = DMatrix::from_fn(n, n, |_, _| rng.random_range(-1.0..1.0));
            let a = &root * root.transpose() + DMatrix::identity(n, n);
            let whole = a.clone().cholesky().map_or_else(|| DMatrix::zeros(0, 0), |f| f.unpack());
            let factor = cholesky(a).map_or_else(|| DMatrix::zeros(0, 0), |f| f.unpack());
            assert!((&factor - &whole).amax() < 1e-11 * n.max(1) as f64, "{n}");
            let inverse = &whole * inverse_lower(&factor) - DMatrix::identity(n, n);
            assert!(inverse.is_empty() || inverse.amax() < 1e-11 * n as f64, "{n}");
            for columns in [1, TASK - 1, TASK + 1, 2 * TASK + 1] {
                let b = DMatrix::from_fn(n, columns, |_, _| rng.random_range(-1.0..1.0));
                let mut x = b.clone();
                solve_lower(&factor, &mut x);
                let back = &whole * &x - b;
                assert!(back.is_empty() || back.amax() < 1e-11 * n as f64, "{n} x {columns}");
            }
        }
    }

    /// A factor whose last unknowns are all but sums of the first ones.
    #[test]
    fn a_nearly_singular_triangle_is_solved_as_one_unknown_after_the_other() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for n in [48, 60, 200] {
            let root = DMatrix::from_fn(n, 8, |_, _| rng.random_range(-1.0..1.0));
            let mut a = &root * root.transpose();
            (0..n).for_each(|i| a[(i, i)] += 1e-12);
            let l = a.cholesky().unwrap().unpack();
            let b = DMatrix::from_fn(n, 3, |_, _| rng.random_range(-1.0..1.0));
            let mut x = b.clone();
            solve_lower(&l, &mut x);
            let one = l.solve_lower_triangular(&b).unwrap();
            let apart = (&x - &one).norm() / one.norm();
            assert!(apart < 1e-8, "{n}: {apart}");
        }
    }

    #[test]
    fn what_is_not_positive_has_no_factor() {
        for n in [1, 50, 200] {
            let mut a = DMatrix::identity(n, n);
            a[(n - 1, n - 1)] = -1.0;
            assert!(cholesky(a).is_none());
        }
    }
}
