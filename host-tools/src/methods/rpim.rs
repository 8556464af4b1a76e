//! The paper's method, as printed and as built here.

use nalgebra::DMatrix;

use super::{Method, Solution, Task};
use crate::error::Result;
use crate::identify::fit::estimate::regularised;
use crate::identify::fit::{Freedom, fit};
use crate::identify::{LambdaRule, State};
use crate::tikhonov::{Factorised, Triangle};

/// RPIM as printed: `lambda I` on metres and radians, one linearisation, lambda
/// from the L-curve (Eq. 15, 16), refined in two steps on the training error.
pub struct PrintedRpim;

/// RPIM as truearm does it: iterated, every parameter weighed by its tolerance
/// and every residual by its sigma, lambda by the default rule; base and tool
/// always with the rest.
pub struct Rpim;

/// One linearisation of a task, for every lambda.
pub struct Printed<'t, 'd> {
    task: &'t Task<'d>,
    factorised: Factorised,
}

impl<'t, 'd> Printed<'t, 'd> {
    /// At the nominal arm.
    #[must_use]
    pub fn new(task: &'t Task<'d>) -> Self {
        let (u, s) = task.system(task.start());
        let mut matrix = DMatrix::zeros(u.nrows(), u.ncols() + 1);
        matrix.columns_mut(0, u.ncols()).copy_from(&u);
        matrix.set_column(u.ncols(), &s);
        let factorised = Factorised::new(&Triangle::new(&matrix), task.free());
        Self { task, factorised }
    }

    /// The factorised problem.
    #[must_use]
    pub fn factorised(&self) -> &Factorised {
        &self.factorised
    }

    /// The arm after one step with this lambda.
    ///
    /// # Errors
    /// As for [`Task::stepped`].
    pub fn state(&self, lambda: f64) -> Result<State> {
        self.task.stepped(self.task.start(), &self.factorised.solve(lambda))
    }

    /// Mean error of the fitted points with this lambda, m.
    #[must_use]
    pub fn mean_error(&self, lambda: f64) -> f64 {
        self.state(lambda).map_or(f64::INFINITY, |s| self.task.mean_error(&s))
    }

    /// The corner of the L-curve.
    #[must_use]
    pub fn corner(&self) -> f64 {
        let largest = self.factorised.singular_values().iter().copied().fold(0.0, f64::max);
        self.factorised.corner().unwrap_or(1e-6 * largest * largest)
    }

    /// First step of the refinement: 30 values from 1e-9 of the corner to ten
    /// times it.
    #[must_use]
    pub fn decades(&self) -> Vec<f64> {
        let corner = self.corner();
        (0..30).map(|k| corner * 10_f64.powf(-9.0 + 10.0 * f64::from(k) / 29.0)).collect()
    }

    /// Second step: ten values evenly about the best of the first, from 0.18 to
    /// 1.65 times it, as the paper's are.
    #[must_use]
    pub fn tenths(&self, best: f64) -> Vec<f64> {
        (0..10).map(|k| best * (0.563 + 0.5 * f64::from(k)) / 3.063).collect()
    }

    /// The least training error of some lambdas.
    #[must_use]
    pub fn best(&self, lambdas: &[f64]) -> f64 {
        let errors = lambdas.iter().map(|l| (*l, self.mean_error(*l)));
        errors.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |b| b.0)
    }

    /// Both steps.
    #[must_use]
    pub fn two_step(&self) -> f64 {
        self.best(&self.tenths(self.best(&self.decades())))
    }
}

impl Method for PrintedRpim {
    fn name(&self) -> &'static str {
        "RPIM-P"
    }

    fn about(&self) -> &'static str {
        "RPIM as printed: lambda I, one step, L-curve and two-step on the training error"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        let printed = Printed::new(task);
        let lambda = printed.two_step();
        let state = printed.state(lambda)?;
        Ok(Solution { state, iterations: 1, lambda: Some(lambda), settled: true })
    }
}

impl Method for Rpim {
    fn name(&self) -> &'static str {
        "RPIM"
    }

    fn about(&self) -> &'static str {
        "RPIM of truearm: iterated, tolerances as prior, base and tool refined"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        let first = fit(&task.problem, &task.rows, None, &task.start, Freedom::All(1.0))?;
        let rule = LambdaRule::default();
        let (found, lambda) = regularised(&task.problem, rule, &task.rows, &first)?;
        let (state, iterations) = (found.state, first.steps + found.steps + 2);
        Ok(Solution { state, iterations, lambda: Some(lambda), settled: true })
    }
}
