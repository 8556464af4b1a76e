//! The extended Kalman filter: one point after the other.

use nalgebra::{DMatrix, DVector};

use super::{Method, Solution, Task};
use crate::error::{Error, ErrorKind, Result};
use crate::identify::{State, Unknown};

/// EKF over the parameters, which do not move in time. The prior is the
/// tolerance of each link parameter and a wide one for frames; the measurement
/// noise is each row's sigma.
pub struct Kalman {
    /// Linearise every point where the points before it led; otherwise all at
    /// the start, as one Gauss-Newton step does.
    pub relinearise: bool,
    /// Prior standard deviation of frames, in tolerances.
    pub wide: f64,
}

impl Default for Kalman {
    fn default() -> Self {
        Self { relinearise: true, wide: 1e3 }
    }
}

impl Kalman {
    /// Standard deviation of each unknown before the first point, m and rad.
    #[must_use]
    pub fn prior(&self, task: &Task) -> DVector<f64> {
        let of = |u: &Unknown| match u {
            Unknown::Link(..) => task.problem.tolerance(*u),
            _ => u.tolerance() * self.wide,
        };
        DVector::from_iterator(task.unknowns().len(), task.unknowns().iter().map(of))
    }
}

impl Method for Kalman {
    fn name(&self) -> &'static str {
        "EKF"
    }

    fn about(&self) -> &'static str {
        "extended Kalman filter, one pass, prior of the tolerances"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        let n = task.unknowns().len();
        let mut p = DMatrix::from_diagonal(&self.prior(task).map(|s| s * s));
        let identity = DMatrix::<f64>::identity(n, n);
        let mut state: State = task.start().clone();
        // What has been learnt since `state` was last moved.
        let mut x = DVector::<f64>::zeros(n);
        let at_start = task.problem.linearise(&state);
        for index in 0..task.rows.len() {
            let (h, residual) = if self.relinearise {
                task.row(&task.problem.linearise(&state), index)
            } else {
                let (h, residual) = task.row(&at_start, index);
                let left = residual - &h * &x;
                (h, left)
            };
            let sigmas = task.problem.scale(task.rows[index]);
            let noise = DMatrix::from_diagonal(&sigmas.map(|s| s * s).column().into_owned());
            let pht = &p * h.transpose();
            let inverse = (&h * &pht + &noise).try_inverse().ok_or_else(|| {
                Error::data(
                    ErrorKind::Singular,
                    "the innovation covariance is singular",
                    "give a sigma above zero",
                )
            })?;
            let gain = &pht * inverse;
            let step = &gain * residual;
            // Joseph's form keeps the covariance symmetric and positive.
            let keep = &identity - &gain * &h;
            p = &keep * p * keep.transpose() + &gain * noise * gain.transpose();
            if self.relinearise {
                state = task.stepped(&state, &step)?;
            } else {
                x += step;
            }
        }
        let state = if self.relinearise { state } else { task.stepped(&state, &x)? };
        Ok(Solution { state, iterations: task.rows.len(), lambda: None, settled: true })
    }
}
