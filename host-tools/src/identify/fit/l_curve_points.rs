//! The L-curve at a solution: what every lambda leaves of the residual and asks
//! of the corrections (paper Eq. 15).

use schemars::JsonSchema;
use serde::Serialize;

use crate::tikhonov::Factorised;

/// Steps of a decade that are shown.
const EVERY: usize = 4;

/// A point of the L-curve. With prior scaling residuals count standard
/// deviations and corrections tolerances; as printed, metres and radians.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LCurvePoint {
    /// The regularisation parameter.
    pub lambda: f64,
    /// Root mean square of the residuals of the equations.
    pub residual: f64,
    /// Norm of the corrections.
    pub corrections: f64,
}

/// The curve of a problem, from least lambda to largest, with a point at `lambda`,
/// the last.
#[must_use]
pub fn l_curve(solved: &Factorised, equations: usize, lambda: f64) -> Vec<LCurvePoint> {
    let count = equations.max(1) as f64;
    let point = |lambda: f64| LCurvePoint {
        lambda,
        residual: (solved.residual_square(lambda) / count).sqrt(),
        corrections: solved.norm_square(lambda).sqrt(),
    };
    let grid = solved.grid().into_iter().step_by(EVERY).filter(|lambda| *lambda > 0.0);
    grid.chain([lambda]).map(point).collect()
}
