//! The same rows where moments bend other springs: all else of their sums stays.

use nalgebra::{DMatrix, DVector};

use super::Sheet;
use crate::evidence::poses::Repeats;
use crate::evidence::{Exchange, Gram};

impl Sheet<'_> {
    /// The sums `whole` of rows where what moments bend is that of another sheet, of the same
    /// state and rows; of columns of candidates only those of this sheet, which stand at
    /// `columns` in the sums.
    #[must_use]
    pub fn exchanged(
        &self,
        other: &Sheet,
        rows: &[usize],
        whole: &Gram,
        columns: &[usize],
    ) -> Gram {
        let held = [self, other].map(|sheet| DVector::from_column_slice(&sheet.held_moments));
        let rigid = self.problem.unknowns.list().len();
        whole.exchanged(&Exchange {
            gone: rigid..self.unknowns(),
            kept: columns,
            products: &self.products(other, rows),
            held: [&held[0], &held[1]],
        })
    }

    /// Products of what moments bend in another sheet with all columns of this one, with itself
    /// and with the residual.
    fn products(&self, other: &Sheet, rows: &[usize]) -> DMatrix<f64> {
        let ([p, k], comes) = (self.size(), other.held_moments.len());
        if comes == 0 {
            return DMatrix::zeros(0, p + k + 1);
        }
        let add = |sum: &mut DMatrix<f64>, all: &DMatrix<f64>, _: &Repeats| {
            sum.gemm(1.0, &all.columns(p + k, comes).transpose(), all, 1.0);
        };
        let none = || DMatrix::zeros(comes, p + k + comes + 1);
        self.summed(rows, Some(other), (&none, &add), &|a, b| a + b)
    }
}
