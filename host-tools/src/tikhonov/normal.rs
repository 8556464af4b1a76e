//! Normal equations: what a least-squares problem needs of its rows when its
//! condition is modest. Sums, so that parts are added and taken away.

use nalgebra::{DMatrix, DMatrixView, DVector};

use super::Triangle;

/// A share of the whole below which what a part leaves of a diagonal is
/// rounding: no difference is then to be trusted.
const LEFT: f64 = 1e-8;
/// Keeps free unknowns that no row moves where they are, as a share of each one's own
/// diagonal (of this share of the largest where it has none): far above rounding, by which
/// they would walk, metres in a dozen steps. It holds steps, not where they end. Of the
/// largest, a torque squared of a heavy arm held everything else.
pub const HELD: f64 = 1e-10;
/// Pivots of equations scaled to ones on the diagonal that are too small to be
/// told from rounding.
const ROUNDING: f64 = 1e-10;

/// `H = A'A`, `g = A'b`, `s = b'b` of weighted equations `A x = b`.
#[derive(Debug, Clone, PartialEq)]
pub struct Normal {
    /// `[A, b]'[A, b]`.
    gram: DMatrix<f64>,
    /// Equations summed.
    equations: usize,
}

impl Normal {
    /// Of a matrix `[A, b]`.
    #[must_use]
    pub fn new(rows: &DMatrix<f64>) -> Self {
        Self::of_columns(&rows.transpose())
    }

    /// Of no equations.
    #[must_use]
    pub fn none(unknowns: usize) -> Self {
        Self { gram: DMatrix::zeros(unknowns + 1, unknowns + 1), equations: 0 }
    }

    /// Of a matrix `[A, b]'`, a column an equation.
    #[must_use]
    pub fn of_columns(columns: &DMatrix<f64>) -> Self {
        let (height, equations) = columns.shape();
        if equations == 0 {
            return Self { gram: DMatrix::zeros(height, height), equations };
        }
        // The transpose in place: a product of two whole matrices is far faster than
        // one by columns, and a copy takes as long as the product.
        let across = columns.as_slice();
        let across = DMatrixView::from_slice_with_strides(across, equations, height, height, 1);
        Self { gram: columns * across, equations }
    }

    /// With these equations, a column `[a; b]` each.
    pub fn add_columns(&mut self, columns: &[f64]) {
        let height = self.gram.ncols();
        let equations = columns.len() / height;
        let along = DMatrixView::from_slice(columns, height, equations);
        let across = DMatrixView::from_slice_with_strides(columns, equations, height, height, 1);
        self.gram.gemm(1.0, &along, &across, 1.0);
        self.equations = self.equations.saturating_add(equations);
    }

    /// Of `[A, b]'[A, b]` of so many equations.
    #[must_use]
    pub fn of_gram(gram: DMatrix<f64>, equations: usize) -> Self {
        Self { gram, equations }
    }

    /// `[A, b]'[A, b]`.
    #[must_use]
    pub fn gram(&self) -> &DMatrix<f64> {
        &self.gram
    }

    /// The same of unknowns y counted in other units and from elsewhere:
    /// `x = units y + from`.
    #[must_use]
    pub fn recounted(&self, units: &DVector<f64>, from: &DVector<f64>) -> Self {
        let size = self.unknowns();
        let mut map = DMatrix::identity(size + 1, size + 1);
        map.view_mut((0, 0), (size, size)).set_diagonal(units);
        // A (units y + from) - b
        map.view_mut((0, size), (size, 1)).copy_from(&-from);
        Self { gram: map.tr_mul(&self.gram) * map, equations: self.equations }
    }

    /// The sum of two parts.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        self.gram += &other.gram;
        self.equations = self.equations.saturating_add(other.equations);
        self
    }

    /// The whole without a part; `None` where so little is left of an unknown
    /// that the difference is rounding.
    #[must_use]
    pub fn minus(&self, part: &Self) -> Option<Self> {
        let gram = &self.gram - &part.gram;
        let left = |k: usize| gram[(k, k)] > LEFT * self.gram[(k, k)] || part.gram[(k, k)] == 0.0;
        let sound = (0..self.unknowns()).all(left);
        sound.then(|| Self { gram, equations: self.equations - part.equations })
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.gram.ncols() - 1
    }

    /// Equations summed.
    #[must_use]
    pub fn equations(&self) -> usize {
        self.equations
    }

    /// `A'A`.
    #[must_use]
    pub fn h(&self) -> DMatrixView<'_, f64> {
        self.gram.view((0, 0), (self.unknowns(), self.unknowns()))
    }

    /// `A'b`.
    #[must_use]
    pub fn g(&self) -> DVector<f64> {
        let p = self.unknowns();
        self.gram.column(p).rows(0, p).into_owned()
    }

    /// `b'b`.
    #[must_use]
    pub fn s(&self) -> f64 {
        self.gram[(self.unknowns(), self.unknowns())]
    }

    /// The solution with lambda on all but the first `free` unknowns; `None`
    /// where rounding makes the equations indefinite.
    #[must_use]
    pub fn solve(&self, free: usize, lambda: f64) -> Option<DVector<f64>> {
        let mut h = self.h().into_owned();
        let least = h.diagonal().max() * HELD * HELD;
        for k in 0..h.nrows() {
            h[(k, k)] += if k < free { HELD * h[(k, k)].max(least) } else { lambda };
        }
        Some(h.cholesky()?.solve(&self.g()))
    }

    /// The step of the first `free` unknowns, the others held at `x`, their own
    /// step zero; `None` where the rows determine it too poorly for normal
    /// equations.
    #[must_use]
    pub fn solve_free(&self, free: usize, x: &DVector<f64>) -> Option<DVector<f64>> {
        let h = self.h();
        let held = x.len() - free;
        let coupling = h.view((0, free), (free, held));
        let rhs = self.g().rows(0, free) - coupling * x.rows(free, held);
        let scale = DVector::from_fn(free, |k, _| h[(k, k)].sqrt().recip());
        let scaled = DMatrix::from_fn(free, free, |i, j| h[(i, j)] * scale[i] * scale[j]);
        let factor = scaled.cholesky()?;
        if factor.l_dirty().diagonal().iter().any(|pivot| pivot * pivot < ROUNDING) {
            return None;
        }
        let mut step = DVector::zeros(x.len());
        let solved = factor.solve(&rhs.component_mul(&scale)).component_mul(&scale);
        step.rows_mut(0, free).copy_from(&solved);
        Some(step)
    }
}

impl From<&Triangle> for Normal {
    fn from(triangle: &Triangle) -> Self {
        Self { gram: triangle.r.tr_mul(&triangle.r), equations: triangle.rows }
    }
}
