//! Evidence of one group at every prior size, the rest of the model fixed. In
//! the axes of what the rest leaves of its C it is a sum, so that all sizes
//! cost one small eigenvalue problem.

use nalgebra::{DMatrix, DVector};

use super::prior::SIZES;

/// Log evidence at each of [`SIZES`].
pub(super) type Curve = [f64; SIZES.len()];

/// Eigenvalues of a positive matrix, and a vector in its axes.
pub(super) fn rotated(matrix: DMatrix<f64>, vector: &DVector<f64>) -> (Vec<f64>, Vec<f64>) {
    if matrix.nrows() == 1 {
        return (vec![matrix[(0, 0)].max(0.0)], vec![vector[0]]);
    }
    if matrix.nrows() == 2 {
        return rotated_pair(&matrix, vector);
    }
    let eigen = matrix.symmetric_eigen();
    let values = eigen.eigenvalues.iter().map(|w| w.max(0.0)).collect();
    (values, eigen.eigenvectors.tr_mul(vector).iter().copied().collect())
}

/// As [`rotated`] of two columns, most of all candidates: one Jacobi rotation.
fn rotated_pair(m: &DMatrix<f64>, vector: &DVector<f64>) -> (Vec<f64>, Vec<f64>) {
    let (a, b, d) = (m[(0, 0)], m[(0, 1)], m[(1, 1)]);
    let angle = 0.5 * (2.0 * b).atan2(a - d);
    let (sin, cos) = angle.sin_cos();
    let first = a * cos * cos + 2.0 * b * cos * sin + d * sin * sin;
    let second = a * sin * sin - 2.0 * b * cos * sin + d * cos * cos;
    let t = vec![vector[0] * cos + vector[1] * sin, vector[1] * cos - vector[0] * sin];
    (vec![first.max(0.0), second.max(0.0)], t)
}

/// Index of the highest.
pub(super) fn highest(curve: &Curve) -> usize {
    (0..curve.len()).fold(0, |best, i| if curve[i] > curve[best] { i } else { best })
}

/// Logarithm of the mean of the evidences.
pub(super) fn mean(curve: &Curve) -> f64 {
    let largest = curve[highest(curve)];
    if !largest.is_finite() {
        return f64::NEG_INFINITY;
    }
    let sum: f64 = curve.iter().map(|e| (e - largest).exp()).sum();
    largest + (sum / curve.len() as f64).ln()
}
