//! Steepest descent.

use super::{Method, Solution, Task};
use crate::error::Result;

/// GD with the fixed step `1 / sigma_1^2`, the longest that is safe in every
/// direction. Stopping early leaves the weak directions near nominal, which is
/// a regularisation of its own kind.
pub struct GradientDescent {
    /// Most iterations.
    pub most: usize,
    /// At rest when the cost falls by less than this share.
    pub rest: f64,
}

impl Default for GradientDescent {
    fn default() -> Self {
        Self { most: 500, rest: 1e-6 }
    }
}

impl Method for GradientDescent {
    fn name(&self) -> &'static str {
        "GD"
    }

    fn about(&self) -> &'static str {
        "gradient descent, fixed step 1 / sigma_1^2"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        let mut state = task.start().clone();
        let mut rate = None;
        let mut last = f64::INFINITY;
        for iterations in 0..self.most {
            let (u, s) = task.system(&state);
            let cost = s.norm_squared();
            if last - cost < self.rest * cost {
                return Ok(Solution { state, iterations, lambda: None, settled: true });
            }
            last = cost;
            let rate = *rate.get_or_insert_with(|| u.singular_values().max().powi(-2));
            state = task.stepped(&state, &(u.tr_mul(&s) * rate))?;
        }
        Ok(Solution { state, iterations: self.most, lambda: None, settled: false })
    }
}
