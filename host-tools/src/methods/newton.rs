//! Gauss-Newton and its damped form.

use nalgebra::{DMatrix, DVector};

use super::least_squares::pseudo_inverse;
use super::{Method, Solution, Task};
use crate::error::{Error, ErrorKind, Result};
use crate::identify::Unknown;
use crate::tikhonov::NOISE;

/// GN: the pseudo-inverse step, repeated, with no control of its length.
pub struct GaussNewton {
    /// Most iterations.
    pub most: usize,
}

impl Default for GaussNewton {
    fn default() -> Self {
        Self { most: 20 }
    }
}

/// GN with redundancy removed beforehand, as Eq. 7 of the paper asks: steps only
/// within the directions that move points of the nominal arm, found once from
/// columns in tolerances. No prior, no damping.
pub struct ReducedGaussNewton {
    /// Most iterations.
    pub most: usize,
}

impl Default for ReducedGaussNewton {
    fn default() -> Self {
        Self { most: 20 }
    }
}

/// LM: `(U'U + mu I) x = U'S`; mu falls after a success and grows after a
/// failure.
pub struct LevenbergMarquardt {
    /// Most linearisations.
    pub most: usize,
}

impl Default for LevenbergMarquardt {
    fn default() -> Self {
        Self { most: 100 }
    }
}

/// A step that moves nothing by more than this, m or rad, is none.
const SMALL: f64 = 1e-9;

/// Full steps within the span of a basis.
fn newton(task: &Task, basis: &DMatrix<f64>, most: usize) -> Result<Solution> {
    let mut state = task.start().clone();
    for iterations in 1..=most {
        let (u, s) = task.system(&state);
        let step = basis * pseudo_inverse(u * basis, &s)?;
        state = task.stepped(&state, &step)?;
        if step.amax() < SMALL {
            return Ok(Solution { state, iterations, lambda: None, settled: true });
        }
    }
    Ok(Solution { state, iterations: most, lambda: None, settled: false })
}

impl Method for GaussNewton {
    fn name(&self) -> &'static str {
        "GN"
    }

    fn about(&self) -> &'static str {
        "Gauss-Newton, pseudo-inverse, full steps"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        let n = task.unknowns().len();
        newton(task, &DMatrix::identity(n, n), self.most)
    }
}

impl Method for ReducedGaussNewton {
    fn name(&self) -> &'static str {
        "GN-R"
    }

    fn about(&self) -> &'static str {
        "Gauss-Newton on the identifiable directions of the nominal arm"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        newton(task, &identifiable(task), self.most)
    }
}

/// Directions that move points of the nominal arm, as columns in m and rad.
fn identifiable(task: &Task) -> DMatrix<f64> {
    let tolerance = |u: &Unknown| task.problem.tolerance(*u);
    let units =
        DVector::from_iterator(task.unknowns().len(), task.unknowns().iter().map(tolerance));
    let scaled = task.system(task.start()).0 * DMatrix::from_diagonal(&units);
    let svd = scaled.svd(false, true);
    let rank = svd.rank(NOISE * svd.singular_values.max());
    let v_t = svd.v_t.unwrap_or_default();
    DMatrix::from_diagonal(&units) * v_t.rows(0, rank).transpose()
}

impl Method for LevenbergMarquardt {
    fn name(&self) -> &'static str {
        "LM"
    }

    fn about(&self) -> &'static str {
        "Levenberg-Marquardt, damping mu I"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        let mut state = task.start().clone();
        let mut mu = None;
        let mut iterations = 0;
        while iterations < self.most {
            iterations += 1;
            let (u, s) = task.system(&state);
            let (h, g, cost) = (u.tr_mul(&u), u.tr_mul(&s), s.norm_squared());
            let mu = mu.get_or_insert_with(|| 1e-3 * h.diagonal().max());
            loop {
                let mut damped = h.clone();
                for k in 0..damped.nrows() {
                    damped[(k, k)] += *mu;
                }
                let Some(factor) = damped.cholesky() else {
                    *mu *= 10.0;
                    continue;
                };
                let step = factor.solve(&g);
                // A step out of reach is no better than one that fails.
                let next = task.stepped(&state, &step).ok();
                let lower = next.as_ref().map_or(f64::INFINITY, |next| task.cost(next));
                if let (Some(next), true) = (next, lower < cost) {
                    *mu /= 10.0;
                    state = next;
                    if cost - lower < 1e-9 * cost {
                        return Ok(Solution { state, iterations, lambda: None, settled: true });
                    }
                    break;
                }
                if step.amax() < SMALL {
                    return Ok(Solution { state, iterations, lambda: None, settled: true });
                }
                *mu *= 10.0;
                if !mu.is_finite() {
                    return Err(Error::data(
                        ErrorKind::NotConverged,
                        "no damping lowers the cost",
                        "check the data",
                    ));
                }
            }
        }
        Ok(Solution { state, iterations, lambda: None, settled: false })
    }
}
