//! What the data say of a subset's coefficients, their sizes and the noise.

use nalgebra::{DMatrix, DVector};

use super::prior::SIZES;
use super::subset::{Subset, Subsets};

/// A coefficient in the caller's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// Posterior mean.
    pub value: f64,
    /// Posterior standard deviation.
    pub sigma: f64,
}

impl Subsets {
    /// Coefficients of the columns of a subset, in the caller's units.
    #[must_use]
    pub fn coefficients(&self, subset: &Subset) -> Vec<Vec<Coefficient>> {
        let k = self.scale_of(subset) / self.scale;
        let mut first = 0;
        let each = subset.members.iter().map(|g| {
            let columns = self.columns[*g].clone();
            let own = columns.enumerate().map(|(i, column)| {
                let unit = self.unit[column];
                if unit <= 0.0 {
                    // Of a column that is nothing in all rows nothing is known.
                    return Coefficient { value: 0.0, sigma: f64::INFINITY };
                }
                let variance = subset.inverse[(first + i, first + i)].max(0.0);
                let value = subset.mean[first + i] / unit;
                Coefficient { value, sigma: k * variance.sqrt() / unit }
            });
            let own: Vec<Coefficient> = own.collect();
            first += own.len();
            own
        });
        each.collect()
    }

    /// Coefficients of the `k`-th member of a subset and their covariance, in the caller's
    /// units; of a column that is nothing in all rows both are nothing.
    #[must_use]
    pub fn block(&self, subset: &Subset, k: usize) -> (DVector<f64>, DMatrix<f64>) {
        let counts = subset.members.iter().map(|g| self.columns[*g].len());
        let first: usize = counts.take(k).sum();
        let columns = self.columns[subset.members[k]].clone();
        let per = |i: usize| {
            let unit = self.unit[columns.start + i];
            if unit > 0.0 { 1.0 / unit } else { 0.0 }
        };
        let noise = (self.scale_of(subset) / self.scale).powi(2);
        let count = columns.len();
        let mean = DVector::from_fn(count, |i, _| subset.mean[first + i] * per(i));
        let covariance = DMatrix::from_fn(count, count, |i, j| {
            noise * subset.inverse[(first + i, first + j)] * per(i) * per(j)
        });
        (mean, covariance)
    }

    /// Size of each member's effect, in noise floors over all equations: its
    /// own columns times their posterior means, geometry projected out.
    #[must_use]
    pub fn floors(&self, subset: &Subset) -> Vec<f64> {
        let mut first = 0;
        let each = subset.members.iter().map(|g| {
            let columns = self.columns[*g].clone();
            let mean = subset.mean.rows(first, columns.len());
            first += columns.len();
            let c = self.c.view((columns.start, columns.start), (columns.len(), columns.len()));
            (mean.dot(&(c * mean)) / self.noise.poses).max(0.0).sqrt()
        });
        each.collect()
    }

    /// Noise scale k that a subset leaves, in stated sigmas.
    #[must_use]
    pub fn scale_of(&self, subset: &Subset) -> f64 {
        let mut first = 0;
        let mut used = 0.0;
        for (g, size) in subset.members.iter().zip(&subset.sizes) {
            for _ in self.columns[*g].clone() {
                used += 1.0 - subset.inverse[(first, first)] / (SIZES[*size] * SIZES[*size]);
                first += 1;
            }
        }
        let left = (self.noise.freedom - used).max(1.0);
        self.scale * (self.noise.own(self.s - subset.explained) / left).sqrt()
    }
}
