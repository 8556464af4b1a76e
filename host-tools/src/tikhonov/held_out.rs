//! What a fit without some of its rows predicts for them, for every lambda,
//! from the factorisation of all rows: the deletion formula
//! `e = (I - H)^-1 r`, H being those rows' block of the hat matrix.

use nalgebra::{DMatrix, DVector};

use super::{Factorised, NOISE};

/// Rows that are left out together.
#[derive(Debug, Clone)]
pub struct HeldOut {
    block: DMatrix<f64>,
    rhs: DVector<f64>,
    /// `H = W C W'`; W'W is all that the inverse needs (Woodbury).
    w: DMatrix<f64>,
    gram: DMatrix<f64>,
    free: usize,
    /// Singular direction of each penalised column of W.
    directions: Vec<usize>,
}

impl HeldOut {
    /// Rows `[A, b]` of a factorised problem.
    #[must_use]
    pub fn new(factorised: &Factorised, rows: &DMatrix<f64>) -> Self {
        let free = factorised.free;
        let columns = rows.ncols() - 1;
        let block = rows.columns(0, columns).into_owned();
        let own = block.columns(0, free) * &factorised.free_inverse;
        let projected = block.columns(free, columns - free) - &own * &factorised.free_coupling;
        let s = &factorised.s;
        let directions: Vec<usize> = (0..s.len()).filter(|k| s[*k] > NOISE * s[0]).collect();
        let mut w = DMatrix::zeros(rows.nrows(), free + directions.len());
        w.columns_mut(0, free).copy_from(&own);
        for (i, k) in directions.iter().enumerate() {
            w.set_column(free + i, &(&projected * factorised.v_t.row(*k).transpose()));
        }
        let gram = w.tr_mul(&w);
        let rhs = rows.column(columns).into_owned();
        Self { block, rhs, w, gram, free, directions }
    }

    /// Measured minus predicted without these rows; `None` where the others do
    /// not determine them.
    #[must_use]
    pub fn residual(&self, factorised: &Factorised, lambda: f64) -> Option<DVector<f64>> {
        let r = &self.rhs - &self.block * factorised.solve(lambda);
        // C^(1/2): every column of W divided by its share of the information.
        let scale = DVector::from_fn(self.w.ncols(), |k, _| match k.checked_sub(self.free) {
            Some(k) => (factorised.s[self.directions[k]].powi(2) + lambda).sqrt().recip(),
            None => 1.0,
        });
        let n = scale.len();
        let left = DMatrix::from_fn(n, n, |i, j| {
            f64::from(u8::from(i == j)) - scale[i] * self.gram[(i, j)] * scale[j]
        });
        let pull = self.w.tr_mul(&r).component_mul(&scale);
        let back = left.cholesky()?.solve(&pull).component_mul(&scale);
        Some(r + &self.w * back)
    }
}
