//! Tikhonov solutions of one least-squares problem for every lambda from one
//! factorisation.
//!
//! The unknowns come in two groups: *free* ones (tracker frames, markers),
//! which are never penalised, and *penalised* ones (link parameters), of which
//! `|A x - b|^2 + lambda |x_penalised|^2` keeps the norm small (paper Eq. 11).
//! Columns are scaled beforehand, so that x counts tolerances.

mod factorised;
mod lambda_rules;
mod normal;
mod triangle;

pub use factorised::Factorised;
pub use normal::{HELD, Normal};
pub use triangle::Triangle;

use nalgebra::{DMatrix, DVector};

/// Singular values below this share of the largest are rounding noise.
pub const NOISE: f64 = 1e-10;
/// The same where they are roots of eigenvalues: normal equations square the
/// condition number.
const NOISE_NORMAL: f64 = 1.5e-7;

/// U, singular values and V' of a matrix, which may be empty.
fn svd(matrix: DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>, DMatrix<f64>) {
    let rows = matrix.nrows();
    if matrix.is_empty() {
        return (DMatrix::zeros(rows, 0), DVector::zeros(0), DMatrix::zeros(0, 0));
    }
    let svd = matrix.svd(true, true);
    (svd.u.unwrap_or_default(), svd.singular_values, svd.v_t.unwrap_or_default())
}

/// Eigenvalues, largest first, and vectors of a symmetric matrix, which may be
/// empty.
fn eigen(matrix: DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let size = matrix.nrows();
    if size == 0 {
        return (DVector::zeros(0), DMatrix::zeros(0, 0));
    }
    let eigen = matrix.symmetric_eigen();
    let mut order: Vec<usize> = (0..size).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let values = DVector::from_fn(size, |k, _| eigen.eigenvalues[order[k]]);
    let vectors = DMatrix::from_fn(size, size, |i, k| eigen.eigenvectors[(i, order[k])]);
    (values, vectors)
}

/// Pseudo-inverse of a symmetric matrix and its rank; columns of one size first,
/// so that what counts as nothing does not depend on units.
fn pseudo_inverse(matrix: DMatrix<f64>) -> (DMatrix<f64>, usize) {
    let size = matrix.nrows();
    let scale = matrix.diagonal().map(|d| if d > 0.0 { d.sqrt().recip() } else { 0.0 });
    let scaled = DMatrix::from_fn(size, size, |i, j| matrix[(i, j)] * scale[i] * scale[j]);
    let (values, vectors) = eigen(scaled);
    let least = NOISE_NORMAL * NOISE_NORMAL * values.iter().copied().fold(0.0, f64::max);
    let rank = values.iter().filter(|e| **e > least).count();
    let mut inverse = DMatrix::zeros(size, size);
    for k in 0..rank {
        let vector = vectors.column(k).component_mul(&scale);
        inverse += &vector * vector.transpose() / values[k];
    }
    (inverse, rank)
}

/// Covariance of the solution: `(A'A + lambda P)^-1` with P the identity on the
/// penalised unknowns, unit noise; directions without information count zero.
#[must_use]
pub fn covariance(normal: &Normal, free: usize, lambda: f64) -> DMatrix<f64> {
    let mut h = normal.h().into_owned();
    for k in free..h.nrows() {
        h[(k, k)] += lambda;
    }
    // Scaled to ones on the diagonal: what is no information is told by no unit then.
    let scale = h.diagonal().map(|own| if own > 0.0 { own.sqrt().recip() } else { 0.0 });
    let (values, vectors) =
        eigen(DMatrix::from_fn(h.nrows(), h.ncols(), |i, j| h[(i, j)] * scale[i] * scale[j]));
    let largest = values.iter().copied().fold(0.0, f64::max);
    let inverse = values.map(|e| if e > 1e-14 * largest { 1.0 / e } else { 0.0 });
    let vectors = DMatrix::from_diagonal(&scale) * vectors;
    &vectors * DMatrix::from_diagonal(&inverse) * vectors.transpose()
}

/// Equations that a fit with this covariance of its unknowns has used up, `tr(C A'A)`: the
/// trace of its hat matrix.
#[must_use]
pub fn used(normal: &Normal, covariance: &DMatrix<f64>) -> f64 {
    covariance.component_mul(&normal.h()).sum()
}
