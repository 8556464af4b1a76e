//! What each candidate would be worth beside a subset: one triangular solve
//! for all of them together.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::curve::{mean, rotated};
use super::subset::{Subset, Subsets};

impl Subsets {
    /// Log mass of the subset with each other candidate added, its prior size
    /// summed over; minus infinity where a member excludes it.
    #[must_use]
    pub fn additions(&self, subset: &Subset) -> Vec<f64> {
        let whole = self.rest(subset);
        let fixed = subset.log_mass - subset.log_evidence;
        let mut out = Vec::with_capacity(self.candidates.len());
        for (g, candidate) in self.candidates.iter().enumerate() {
            let member = |m: &usize| self.candidates[*m].excludes(candidate);
            if subset.members.iter().any(member) {
                out.push(f64::NEG_INFINITY);
                continue;
            }
            let columns = self.columns[g].clone();
            let (values, t) = whole.of(self, columns);
            let curve = self.curve(&values, &t, subset.explained, subset.log_det);
            out.push(mean(&curve) + fixed + candidate.log_odds);
        }
        out
    }

    /// What a subset leaves of all columns.
    fn rest(&self, subset: &Subset) -> Rest {
        let members: Vec<usize> =
            subset.members.iter().flat_map(|g| self.columns[*g].clone()).collect();
        let n = members.len();
        let mut t = self.b.clone();
        // Of members so nearly alike that rounding leaves no root, nothing is taken off.
        let Some(root) = subset.inverse.clone().cholesky() else {
            return Rest { factors: DMatrix::zeros(n, self.b.len()), t };
        };
        let mut factors = DMatrix::zeros(self.b.len(), n);
        // A^-1 = L L': S = C - (C_M L)(C_M L)', and C is symmetric.
        let l = root.l();
        for (j, mut column) in factors.column_iter_mut().enumerate() {
            for i in j..n {
                column.axpy(l[(i, j)], &self.c.column(members[i]), 1.0);
            }
        }
        for (i, mean) in members.iter().zip(subset.mean.iter()) {
            t.axpy(-mean, &self.c.column(*i), 1.0);
        }
        Rest { factors: factors.transpose(), t }
    }
}

/// Columns with a subset projected out: `S = C - factors' factors`.
struct Rest {
    factors: DMatrix<f64>,
    t: DVector<f64>,
}

impl Rest {
    /// Eigenvalues of S of some columns, and their t in its axes.
    fn of(&self, subsets: &Subsets, columns: Range<usize>) -> (Vec<f64>, Vec<f64>) {
        let k = columns.len();
        let own = self.factors.columns(columns.start, k);
        if k == 1 {
            let first = columns.start;
            let s = subsets.c[(first, first)] - own.norm_squared();
            return (vec![s.max(0.0)], vec![self.t[first]]);
        }
        let mut s = subsets.c.view((columns.start, columns.start), (k, k)).into_owned();
        s.gemm_tr(-1.0, &own, &own, 1.0);
        rotated(s, &self.t.rows(columns.start, k).into_owned())
    }
}
