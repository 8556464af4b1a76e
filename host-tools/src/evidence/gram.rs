//! Products of all columns with each other, accumulated block by block: all that the
//! evidence of any subset needs of the rows, however many there are.

use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut, DVector};
use rayon::prelude::*;

use super::poses::Repeats;

/// Columns a product is computed in at a time; only the lower triangle is.
const BLOCK: usize = 96;
/// `G'G`, `G'Z`, `Z'Z`, `G'y`, `Z'y` and `y'y` of the equations so far, G the
/// columns of geometry, Z those of the candidates, y the residual; everything
/// over its stated sigma.
#[derive(Debug, Clone)]
pub struct Gram {
    /// Its lower triangle.
    pub(super) gg: DMatrix<f64>,
    pub(super) gz: DMatrix<f64>,
    pub(super) zz: DMatrix<f64>,
    pub(super) gy: DVector<f64>,
    pub(super) zy: DVector<f64>,
    pub(super) yy: f64,
    pub(super) equations: usize,
    pub(super) repeats: Repeats,
}

impl Gram {
    /// Of no equations.
    #[must_use]
    pub fn new(unknowns: usize, columns: usize) -> Self {
        Self {
            gg: DMatrix::zeros(unknowns, unknowns),
            gz: DMatrix::zeros(unknowns, columns),
            zz: DMatrix::zeros(columns, columns),
            gy: DVector::zeros(unknowns),
            zy: DVector::zeros(columns),
            yy: 0.0,
            equations: 0,
            repeats: Repeats::default(),
        }
    }

    /// Adds equations.
    pub fn add(&mut self, g: &DMatrix<f64>, z: &DMatrix<f64>, y: &DVector<f64>) {
        let columns = g.column_iter().chain(z.column_iter()).chain([y.column(0)]);
        self.add_block(&DMatrix::from_columns(&columns.collect::<Vec<_>>()));
    }

    /// Adds equations `[G, Z, y]`. A few hundred at a time are fastest.
    pub fn add_block(&mut self, all: &DMatrix<f64>) {
        let (p, k) = (self.unknowns(), self.columns());
        let (g, z, y) = (all.columns(0, p), all.columns(p, k), all.column(p + k));
        let transposed = all.transpose();
        let (gt, zt) = (transposed.rows(0, p), transposed.rows(p, k));
        lower_product(&mut self.gg, 1.0, gt, g);
        self.gz.gemm(1.0, &gt, &z, 1.0);
        self.gy.gemv(1.0, &gt, &y, 1.0);
        self.zy.gemv(1.0, &zt, &y, 1.0);
        self.yy += y.norm_squared();
        lower_product(&mut self.zz, 1.0, zt, z);
        self.equations += y.len();
    }

    /// Of the equations added some repeat a pose: what they say of the noise, at the best
    /// model known. Where a later one explains part of their scatter, accumulate again with
    /// its residuals.
    pub fn add_repeats(&mut self, repeats: &Repeats) {
        self.repeats.join(repeats);
    }

    /// Equations that do not repeat a pose.
    #[must_use]
    pub fn poses(&self) -> usize {
        self.equations - self.repeats.equations
    }

    /// Adds the equations of another part of the rows.
    pub fn join(&mut self, other: &Self) {
        self.gg += &other.gg;
        self.gz += &other.gz;
        self.zz += &other.zz;
        self.gy += &other.gy;
        self.zy += &other.zy;
        self.yy += other.yy;
        self.equations += other.equations;
        self.add_repeats(&other.repeats);
    }

    /// Unknowns of geometry.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.gy.len()
    }

    /// Columns of candidates.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.zy.len()
    }

    /// Of two candidates' columns: below the diagonal are those that were summed.
    pub(super) fn product(&self, i: usize, j: usize) -> f64 {
        self.zz[(i.max(j), i.min(j))]
    }
}

/// Adds `by * at * a` to the lower triangle of `to`, at being a's transpose:
/// nalgebra's own product of a transpose took seven times as long.
pub(super) fn lower_product(
    to: &mut DMatrix<f64>,
    by: f64,
    at: DMatrixView<'_, f64>,
    a: DMatrixView<'_, f64>,
) {
    let columns = a.ncols();
    let blocks = to.as_mut_slice().par_chunks_mut(BLOCK * columns.max(1)).enumerate();
    blocks.for_each(|(k, block)| {
        let (first, width) = (k * BLOCK, block.len() / columns);
        let below = columns - first;
        let mut block = DMatrixViewMut::from_slice(block, columns, width);
        let mut target = block.rows_mut(first, below);
        target.gemm(by, &at.rows(first, below), &a.columns(first, width), 1.0);
    });
}
