//! What the host holds the controller's solves against: least squares by difference
//! quotients and a singular value decomposition, in `f64`.

use nalgebra::{DMatrix, DVector};

/// Step of the difference quotients, rad or m.
const STEP: f64 = 1e-6;
/// Gauss-Newton steps, of which two or three matter.
const STEPS: usize = 6;

/// From zero on; of many solutions the shortest.
pub fn least_squares(unknowns: usize, residual: impl Fn(&[f64]) -> DVector<f64>) -> DVector<f64> {
    let mut x = DVector::zeros(unknowns);
    for _ in 0..STEPS {
        let rest = residual(x.as_slice());
        let columns: Vec<DVector<f64>> = (0..unknowns)
            .map(|k| {
                let mut moved = x.clone();
                moved[k] += STEP;
                (&rest - residual(moved.as_slice())) / STEP
            })
            .collect();
        let jacobian = DMatrix::from_columns(&columns);
        let whole = rest + &jacobian * &x;
        // Neither vectors nor threshold are missing: this cannot fail.
        x = jacobian.svd(true, true).solve(&whole, 1e-6).unwrap_or(x);
    }
    x
}
