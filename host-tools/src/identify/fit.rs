//! Gauss-Newton: linearise, solve the regularised problem, repeat until the
//! step no longer matters. (The paper stops after the first step.)

use nalgebra::{DVector, Vector3};

use super::problem::{Linearised, Problem, Scaling};
use super::unknowns::State;
use crate::error::{Error, Kind, Result};
use crate::tikhonov::{Factorised, Triangle};

/// A step below this many tolerances (a picometre, a nanoradian) is no step.
const CONVERGED: f64 = 1e-6;
const MOST_STEPS: usize = 30;

/// Which unknowns a fit moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// Bases and markers; links stay as they are.
    Frames,
    /// Everything, with this lambda.
    All(f64),
}

/// A converged state and its linearisation.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The state.
    pub state: State,
    /// Triangle of the fitted rows at this state.
    pub triangle: Triangle,
    /// Gauss-Newton steps taken.
    pub steps: usize,
}

/// Fits the given rows from a state.
///
/// # Errors
/// When the iteration runs away or does not settle.
pub fn fit(
    problem: &Problem,
    rows: &[usize],
    weights: Option<&[Vector3<f64>]>,
    start: &State,
    freedom: Freedom,
) -> Result<Fit> {
    let mut state = start.clone();
    let mut last = f64::INFINITY;
    for steps in 0..MOST_STEPS {
        let at = problem.linearise(&state);
        let (step, triangle) = match (problem.scaling, freedom) {
            // Regularised in tolerances the normal equations are safe, and far
            // cheaper than a QR factorisation.
            (Scaling::Prior, Freedom::All(lambda)) if lambda >= 1e-3 => {
                (normal_step(problem, &at, rows, weights, lambda), None)
            }
            _ => (None, Some(at.triangle(rows, weights))),
        };
        let (step, triangle) = match (step, triangle) {
            (Some(step), triangle) => (step, triangle),
            (None, triangle) => {
                let triangle = triangle.unwrap_or_else(|| at.triangle(rows, weights));
                (newton_step(problem, &triangle, at.corrections(), freedom), Some(triangle))
            }
        };
        let size = step.amax();
        let step = at.to_si(&step);
        // In the paper's units a link step counts metres, not tolerances.
        let floor = match problem.scaling {
            Scaling::Prior => CONVERGED,
            Scaling::Printed => CONVERGED * 1e-3,
        };
        if size < floor || (steps > 3 && size < 100.0 * floor && size >= 0.5 * last) {
            let triangle = triangle.unwrap_or_else(|| at.triangle(rows, weights));
            drop(at);
            return Ok(Fit { state, triangle, steps });
        }
        if !size.is_finite() || step.amax() > 1e3 {
            break;
        }
        last = size;
        drop(at);
        state = state.stepped(&problem.unknowns, &step);
    }
    Err(Error::data(
        Kind::NotConverged,
        "the identification does not converge",
        "check joint senses, units and the nominal geometry; a wrong sign of one joint is enough",
    ))
}

/// The step by Cholesky factorisation of the normal equations; `None` where
/// rounding makes them indefinite.
fn normal_step(
    problem: &Problem,
    at: &Linearised,
    rows: &[usize],
    weights: Option<&[Vector3<f64>]>,
    lambda: f64,
) -> Option<DVector<f64>> {
    let columns = at.corrections().len();
    let matrix = at.rows(rows, weights);
    let (a, b) = (matrix.columns(0, columns), matrix.column(columns));
    let transposed = a.transpose();
    let mut h = &transposed * a;
    let rhs = &transposed * b;
    let largest = h.diagonal().max();
    for k in 0..columns {
        let free = k < problem.unknowns.free();
        h[(k, k)] += if free { largest * 1e-14 } else { lambda };
    }
    // rhs counts corrections from nominal; free unknowns have none.
    Some(h.cholesky()?.solve(&rhs) - at.corrections())
}

/// The step in units from a triangle linearised where the corrections are `x`.
#[must_use]
pub fn newton_step(
    problem: &Problem,
    triangle: &Triangle,
    x: &DVector<f64>,
    freedom: Freedom,
) -> DVector<f64> {
    let factorised = Factorised::new(triangle, problem.unknowns.free());
    match freedom {
        Freedom::All(lambda) => factorised.solve(lambda) - x,
        Freedom::Frames => factorised.solve_free(x),
    }
}
