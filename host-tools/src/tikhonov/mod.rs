//! Tikhonov solutions of one least-squares problem for every lambda from one
//! factorisation.
//!
//! The unknowns come in two groups: *free* ones (tracker frames, markers),
//! which are never penalised, and *penalised* ones (link parameters), of which
//! `|A x - b|^2 + lambda |x_penalised|^2` keeps the norm small (paper Eq. 11).
//! Columns are scaled beforehand, so that x counts tolerances.

mod held_out;
mod rules;

pub use held_out::HeldOut;

use nalgebra::{DMatrix, DVector};

/// Singular values below this share of the largest are rounding noise.
pub const NOISE: f64 = 1e-10;

/// `[R, Q'b; 0, rest]` of the QR factorisation of `[A, b]`: all that a
/// least-squares problem needs of its rows, however many there are.
#[derive(Debug, Clone)]
pub struct Triangle {
    r: DMatrix<f64>,
    /// Equations it was made of.
    rows: usize,
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

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.r.ncols() - 1
    }

    /// The triangle of A.
    #[must_use]
    pub fn matrix(&self) -> DMatrix<f64> {
        let p = self.unknowns();
        self.r.view((0, 0), (p + 1, p)).into_owned()
    }
}

/// U, singular values and V' of a matrix, which may be empty.
fn svd(matrix: DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>, DMatrix<f64>) {
    let rows = matrix.nrows();
    if matrix.is_empty() {
        return (DMatrix::zeros(rows, 0), DVector::zeros(0), DMatrix::zeros(0, 0));
    }
    let svd = matrix.svd(true, true);
    (svd.u.unwrap_or_default(), svd.singular_values, svd.v_t.unwrap_or_default())
}

/// A problem factorised for every lambda.
#[derive(Debug, Clone)]
pub struct Factorised {
    free: usize,
    /// Pseudo-inverse of the free block and its coupling to the penalised one.
    free_inverse: DMatrix<f64>,
    free_coupling: DMatrix<f64>,
    free_rhs: DVector<f64>,
    /// Singular values, right vectors and rotated right-hand side of the
    /// penalised block, the free unknowns projected out.
    s: DVector<f64>,
    v_t: DMatrix<f64>,
    beta: DVector<f64>,
    /// What no solution reaches.
    rest: f64,
    /// Equations left when the free unknowns have taken theirs.
    equations: f64,
}

impl Factorised {
    /// Factorises; the first `free` unknowns are not penalised.
    #[must_use]
    pub fn new(triangle: &Triangle, free: usize) -> Self {
        let t = &triangle.r;
        let p = triangle.unknowns();
        let penalised = p - free;
        let (u, s, v_t) = svd(t.view((0, 0), (free, free)).into_owned());
        let largest = s.iter().copied().fold(0.0, f64::max);
        let keep: Vec<bool> = s.iter().map(|s| *s > NOISE * largest).collect();
        let mut inverse = DMatrix::zeros(free, free);
        for k in (0..free).filter(|k| keep[*k]) {
            inverse += v_t.row(k).transpose() * u.column(k).transpose() / s[k];
        }
        let coupling = t.view((0, free), (free, penalised)).into_owned();
        let free_rhs = t.view((0, p), (free, 1)).column(0).into_owned();
        // What the free unknowns cannot reach belongs to the penalised block.
        let lost: Vec<usize> = (0..free).filter(|k| !keep[*k]).collect();
        let below = p + 1 - free;
        let mut block = DMatrix::zeros(below + lost.len(), penalised);
        let mut rhs = DVector::zeros(below + lost.len());
        block.rows_mut(0, below).copy_from(&t.view((free, free), (below, penalised)));
        rhs.rows_mut(0, below).copy_from(&t.view((free, p), (below, 1)));
        for (i, k) in lost.into_iter().enumerate() {
            block.row_mut(below + i).copy_from(&(u.column(k).transpose() * &coupling));
            rhs[below + i] = u.column(k).dot(&free_rhs);
        }
        let (u, s, v_t) = svd(block);
        let beta = u.tr_mul(&rhs);
        let rest = (rhs.norm_squared() - beta.norm_squared()).max(0.0);
        let taken = keep.iter().filter(|k| **k).count();
        let equations = triangle.rows.saturating_sub(taken) as f64;
        Self {
            free,
            free_inverse: inverse,
            free_coupling: coupling,
            free_rhs,
            s,
            v_t,
            beta,
            rest,
            equations,
        }
    }

    /// Singular values of the penalised block, largest first.
    #[must_use]
    pub fn singular_values(&self) -> &DVector<f64> {
        &self.s
    }

    /// Gain of singular direction k; zero where it is rounding noise.
    fn gain(&self, k: usize, lambda: f64) -> f64 {
        let s = self.s[k];
        if s > NOISE * self.s[0] { s / (s * s + lambda) } else { 0.0 }
    }

    /// The solution for one lambda, free unknowns first.
    #[must_use]
    pub fn solve(&self, lambda: f64) -> DVector<f64> {
        let mut x = DVector::zeros(self.free + self.s.len());
        let y = DVector::from_fn(self.s.len(), |k, _| self.gain(k, lambda) * self.beta[k]);
        let penalised = self.v_t.transpose() * y;
        let rhs = &self.free_rhs - &self.free_coupling * &penalised;
        x.rows_mut(0, self.free).copy_from(&(&self.free_inverse * rhs));
        x.rows_mut(self.free, self.s.len()).copy_from(&penalised);
        x
    }

    /// The step of the free unknowns with the penalised ones held at `x`; the
    /// step of these is zero.
    #[must_use]
    pub fn solve_free(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut step = DVector::zeros(x.len());
        let held = x.rows(self.free, self.s.len());
        let rhs = &self.free_rhs - &self.free_coupling * held;
        step.rows_mut(0, self.free).copy_from(&(&self.free_inverse * rhs));
        step
    }

    /// `|A x - b|^2` of the solution for one lambda.
    #[must_use]
    pub fn residual_square(&self, lambda: f64) -> f64 {
        let left = |k: usize| (1.0 - self.gain(k, lambda) * self.s[k]) * self.beta[k];
        self.rest + (0..self.s.len()).map(|k| left(k).powi(2)).sum::<f64>()
    }

    /// `|x_penalised|^2` of the solution for one lambda.
    #[must_use]
    pub fn norm_square(&self, lambda: f64) -> f64 {
        (0..self.s.len()).map(|k| (self.gain(k, lambda) * self.beta[k]).powi(2)).sum()
    }
}

/// Covariance of the solution: `(A'A + lambda P)^-1` with P the identity on the
/// penalised unknowns, unit noise; directions without information count zero.
#[must_use]
pub fn covariance(triangle: &Triangle, free: usize, lambda: f64) -> DMatrix<f64> {
    let mut h = triangle.matrix().tr_mul(&triangle.matrix());
    for k in free..h.nrows() {
        h[(k, k)] += lambda;
    }
    let eigen = h.symmetric_eigen();
    let largest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let inverse = eigen.eigenvalues.map(|e| if e > 1e-15 * largest { 1.0 / e } else { 0.0 });
    &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.transpose()
}
