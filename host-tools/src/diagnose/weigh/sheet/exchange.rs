//! The same rows where moments bend other springs: all else of their sums stays.

use nalgebra::{DMatrix, DVector};

use super::{PART, Sheet, by_pose};
use crate::evidence::{Exchange, Gram};
use crate::identify::problem::accumulate::tree;

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

    /// Products of what moments bend in another sheet with all columns of this one, with the
    /// residual and with itself.
    fn products(&self, other: &Sheet, rows: &[usize]) -> DMatrix<f64> {
        let ([p, k], comes) = (self.size(), other.held_moments.len());
        if comes == 0 {
            return DMatrix::zeros(0, p + k + 1);
        }
        let of_rows = |places: &Vec<usize>| places.iter().map(|k| rows[*k]).collect();
        let readings: Vec<Vec<usize>> = by_pose(self.problem, rows).iter().map(of_rows).collect();
        let all: Vec<usize> = (0..readings.len()).collect();
        let leaf = |own: &[usize]| {
            let mut sum = DMatrix::zeros(comes, p + k + comes + 1);
            self.stacks(own.iter().map(|k| &readings[*k][..]), Some(other), &mut |all, _| {
                sum.gemm(1.0, &all.columns(p + k, comes).transpose(), all, 1.0);
            });
            sum
        };
        let sums = tree(&all, PART, &leaf, &|a: DMatrix<f64>, b| a + b);
        // The residual stands before what comes.
        let own = sums.columns(p + k, comes).into_owned();
        let mut out = sums.remove_columns(p + k, comes).resize_horizontally(p + k + 1 + comes, 0.0);
        out.columns_mut(p + k + 1, comes).copy_from(&own);
        out
    }
}
