//! Least squares in one step on all parameters, as textbooks write it.

use nalgebra::{DMatrix, DVector};

use super::{Method, Solution, Task};
use crate::error::{Error, ErrorKind, Result};

/// LSM by the pseudo-inverse: `x = U^+ S`, singular values below rounding
/// (`max(m, n) eps sigma_1`, as pinv of Matlab and numpy) counting as zero.
pub struct PseudoInverse;

/// LSM by the normal equations: `x = (U'U)^-1 U'S`.
pub struct NormalEquations;

/// The step of the pseudo-inverse, lengths shortest among all that fit alike.
///
/// # Errors
/// When the singular values cannot be found.
pub(super) fn pseudo_inverse(u: DMatrix<f64>, s: &DVector<f64>) -> Result<DVector<f64>> {
    let size = u.nrows().max(u.ncols()) as f64;
    let svd = u.svd(true, true);
    let zero = size * f64::EPSILON * svd.singular_values.max();
    svd.solve(s, zero).map_err(|e| Error::data(ErrorKind::Singular, e, "check the measurements"))
}

impl Method for PseudoInverse {
    fn name(&self) -> &'static str {
        "LSM"
    }

    fn about(&self) -> &'static str {
        "least squares, one step, pseudo-inverse"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        let (u, s) = task.system(task.start());
        let state = task.stepped(task.start(), &pseudo_inverse(u, &s)?)?;
        Ok(Solution { state, iterations: 1, lambda: None, settled: true })
    }
}

impl Method for NormalEquations {
    fn name(&self) -> &'static str {
        "LSM-N"
    }

    fn about(&self) -> &'static str {
        "least squares, one step, inverse of the normal equations"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        let (u, s) = task.system(task.start());
        let step = u.tr_mul(&u).lu().solve(&u.tr_mul(&s)).ok_or_else(|| {
            Error::data(
                ErrorKind::Singular,
                "the normal equations are singular",
                "use a regularised method",
            )
        })?;
        let state = task.stepped(task.start(), &step)?;
        Ok(Solution { state, iterations: 1, lambda: None, settled: true })
    }
}
