//! QR factorisations, row by row and part by part.

use nalgebra::{DMatrix, DVector};

/// `[R, Q'b; 0, rest]` of the QR factorisation of `[A, b]`: all that a
/// least-squares problem needs of its rows, however many there are.
#[derive(Debug, Clone)]
pub struct Triangle {
    pub(super) r: DMatrix<f64>,
    /// Equations it was made of.
    pub(super) rows: usize,
}

impl Triangle {
    /// Of a matrix `[A, b]`, in pieces that stay in the processor's cache.
    #[must_use]
    pub fn new(rows: &DMatrix<f64>) -> Self {
        let columns = rows.ncols();
        let chunk = (4 * columns).max(64);
        let mut r = DMatrix::zeros(0, columns);
        for start in (0..rows.nrows().max(1)).step_by(chunk) {
            let count = chunk.min(rows.nrows() - start);
            let mut stacked = DMatrix::zeros(r.nrows() + count, columns);
            stacked.rows_mut(0, r.nrows()).copy_from(&r);
            stacked.rows_mut(r.nrows(), count).copy_from(&rows.rows(start, count));
            r = stacked.qr().unpack_r();
        }
        // Few rows give a flat triangle; fill it up.
        let have = r.nrows();
        Self { r: r.resize_vertically(have.max(columns), 0.0), rows: rows.nrows() }
    }

    /// Of all rows of several problems together.
    #[must_use]
    pub fn join<'a>(parts: impl Iterator<Item = &'a Self>) -> Self {
        let parts: Vec<_> = parts.collect();
        let columns = parts.first().map_or(0, |p| p.r.ncols());
        let mut stacked = DMatrix::zeros(parts.len() * columns, columns);
        for (i, part) in parts.iter().enumerate() {
            stacked.rows_mut(i * columns, columns).copy_from(&part.r);
        }
        Self { rows: parts.iter().map(|p| p.rows).sum(), ..Self::new(&stacked) }
    }

    /// Of all parts but one, for each; nothing is taken away, so that nothing is
    /// lost to rounding.
    #[must_use]
    pub fn without_each(parts: &[Self]) -> Vec<Self> {
        let joined = |a: &Option<Self>, b: &Self| match a {
            Some(a) => Some(Self::join([a, b].into_iter())),
            None => Some(b.clone()),
        };
        let mut before = vec![None];
        for part in parts {
            before.push(joined(before.last().unwrap_or(&None), part));
        }
        let mut after: Option<Self> = None;
        let mut out = Vec::new();
        for (k, part) in parts.iter().enumerate().rev() {
            out.push(match (&before[k], &after) {
                (Some(a), Some(b)) => Self::join([a, b].into_iter()),
                (Some(one), None) | (None, Some(one)) => one.clone(),
                (None, None) => Self::new(&DMatrix::zeros(0, part.r.ncols())),
            });
            after = joined(&after, part);
        }
        out.reverse();
        out
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.r.ncols() - 1
    }

    /// `|A x - b|^2`.
    #[must_use]
    pub fn residual_square(&self, x: &DVector<f64>) -> f64 {
        let p = self.unknowns();
        (self.r.columns(0, p) * x - self.r.column(p)).norm_squared()
    }

    /// The triangle of A.
    #[must_use]
    pub fn matrix(&self) -> DMatrix<f64> {
        let p = self.unknowns();
        self.r.view((0, 0), (p + 1, p)).into_owned()
    }
}
