//! How well the tool point is known where joints have error curves.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::{HELD, Sheet};
use crate::evidence::Gram;
use crate::model::arm::Derivatives;

/// Rows at which it is asked for: each is a right-hand side of two triangles a coordinate.
const LOOKS: usize = 300;

/// What is not known of the curves, and of geometry on account of them: variance of a
/// coordinate of the target beyond that with the curves held, m^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ByCurves {
    /// Mean over rows and coordinates.
    pub mean: f64,
    /// Largest.
    pub largest: f64,
}

impl Sheet<'_> {
    /// Over rows, with the sums `whole` at a noise scale. A curve's constant and slow part
    /// are those of geometry too: its band alone, as if it stood for itself, says too much.
    #[must_use]
    pub fn by_curves_unknown(&self, rows: &[usize], whole: &Gram, of: (f64, f64)) -> ByCurves {
        let (lambda, scale) = of;
        let free = self.precision(lambda);
        let mut held = free.clone();
        held.rows_mut(self.unknowns(), held.len() - self.unknowns()).fill(HELD);
        let [free, held] = [free, held].map(|precision| whole.geometry(&precision, scale));
        let beside =
            |i: usize, d: &Derivatives| [self.of_moments(i, d), self.of_curves(i, d)].concat();
        let looks: Vec<usize> =
            rows.iter().copied().step_by(rows.len().div_ceil(LOOKS).max(1)).collect();
        let of_row = |row: &usize| self.at.target_beside(*row, &beside).transpose();
        let blocks: Vec<DMatrix<f64>> = looks.par_iter().map(of_row).collect();
        let mut all = DMatrix::zeros(free.unknowns(), 3 * blocks.len());
        for (k, block) in blocks.iter().enumerate() {
            all.columns_mut(3 * k, 3).copy_from(block);
        }
        let [free, held] = [free.variances(all.clone()), held.variances(all)];
        let variances = free.into_iter().zip(held).map(|(free, held)| (free - held).max(0.0));
        let variances: Vec<f64> = variances.collect();
        ByCurves {
            mean: variances.iter().sum::<f64>() / variances.len().max(1) as f64,
            largest: variances.into_iter().fold(0.0, f64::max),
        }
    }
}
