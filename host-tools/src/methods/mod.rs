//! Every method the paper compares, behind one interface: from a registered
//! nominal arm and its measurements to an identified state.
//!
//! The classical methods are built as a paper would state them: in metres and
//! radians, on all parameters at once, redundant ones included, with no prior.
//! What goes wrong with them is then theirs, not the program's.

mod compare;
mod descent;
mod kalman;
mod least_squares;
mod newton;
mod rpim;

pub use compare::{Comparison, Outcome, compare};
pub use descent::GradientDescent;
pub use kalman::Kalman;
pub use least_squares::{NormalEquations, PseudoInverse};
pub use newton::{GaussNewton, LevenbergMarquardt, ReducedGaussNewton};
pub use rpim::{Printed, PrintedRpim, Rpim};

use nalgebra::{DMatrix, DVector};

use crate::error::{Error, ErrorKind, Result};
use crate::identify::{Linearised, Problem, Scaling, State, Unknown};

/// Which unknowns the classical methods move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frames {
    /// Base and tool together with the links.
    #[default]
    Fitted,
    /// Links alone; base and tool stay as registered on the nominal arm, as in
    /// the paper, whose Jacobian has MD-H parameters only (Eq. 7).
    Held,
}

/// What a method is given.
pub struct Task<'a> {
    problem: Problem<'a>,
    start: State,
    rows: Vec<usize>,
    frames: Frames,
    columns: std::ops::Range<usize>,
}

impl<'a> Task<'a> {
    /// `start` is the nominal arm, base and tool registered.
    #[must_use]
    pub fn new(problem: &Problem<'a>, start: State, rows: &[usize], frames: Frames) -> Self {
        let problem = Problem { scaling: Scaling::Prior, ..problem.clone() };
        let all = problem.unknowns.list().len();
        let columns = match frames {
            Frames::Fitted => 0..all,
            Frames::Held => problem.unknowns.free()..all,
        };
        Self { problem, start, rows: rows.to_vec(), frames, columns }
    }

    /// The nominal arm, registered.
    #[must_use]
    pub fn start(&self) -> &State {
        &self.start
    }

    /// Unknowns that are moved.
    #[must_use]
    pub fn unknowns(&self) -> &[Unknown] {
        &self.problem.unknowns.list()[self.columns.clone()]
    }

    /// How many of them are frames, which come first.
    #[must_use]
    pub fn free(&self) -> usize {
        match self.frames {
            Frames::Fitted => self.problem.unknowns.free(),
            Frames::Held => 0,
        }
    }

    /// Jacobian U and residual S at a state (paper Eq. 7), m and rad.
    #[must_use]
    pub fn system(&self, state: &State) -> (DMatrix<f64>, DVector<f64>) {
        let at = self.problem.linearise(state);
        let equations = self.problem.equations(&self.rows);
        let mut u = DMatrix::zeros(equations, self.columns.len());
        let mut s = DVector::zeros(equations);
        let mut first = 0;
        for index in 0..self.rows.len() {
            let (block, residual) = self.row(&at, index);
            u.rows_mut(first, residual.len()).copy_from(&block);
            s.rows_mut(first, residual.len()).copy_from(&residual);
            first += residual.len();
        }
        (u, s)
    }

    /// The equations of one row.
    fn row(&self, at: &Linearised, index: usize) -> (DMatrix<f64>, DVector<f64>) {
        let e = at.equations(self.rows[index]);
        let units = self.problem.units();
        let first = self.columns.start;
        let entry = |c: usize, k: usize| e.block[(c, first + k)] * e.scale[c] / units[first + k];
        let block = DMatrix::from_fn(e.scale.len(), self.columns.len(), entry);
        (block, e.residual.values().column().into_owned())
    }

    /// Sum of squared residuals, m^2.
    #[must_use]
    pub fn cost(&self, state: &State) -> f64 {
        let at = self.problem.linearise(state);
        self.rows.iter().map(|r| at.residual(*r).values().norm_squared()).sum()
    }

    /// Mean distance between measured and modelled points, m.
    #[must_use]
    pub fn mean_error(&self, state: &State) -> f64 {
        let at = self.problem.linearise(state);
        self.rows.iter().map(|r| at.residual(*r).norm()).sum::<f64>() / self.rows.len() as f64
    }

    /// A state moved by a step of [`Task::unknowns`].
    ///
    /// # Errors
    /// A step so wild that no arm is left.
    pub fn stepped(&self, state: &State, step: &DVector<f64>) -> Result<State> {
        if !step.iter().all(|x| x.abs() < 1e6) {
            return Err(Error::data(
                ErrorKind::Singular,
                "the step is not finite or kilometres long",
                "the problem is singular: use a regularised method",
            ));
        }
        let mut all = DVector::zeros(self.problem.unknowns.list().len());
        all.rows_mut(self.columns.start, self.columns.len()).copy_from(step);
        Ok(state.stepped(&self.problem.unknowns, &all))
    }

    /// Corrections of the links, in tolerances.
    #[must_use]
    pub fn corrections(&self, state: &State) -> DVector<f64> {
        self.problem.corrections(state)
    }

    /// The longest length of corrections, m.
    #[must_use]
    pub fn longest(&self, x: &DVector<f64>) -> f64 {
        let list = self.problem.unknowns.list();
        let length = |k: &usize| list[*k].is_length();
        let longest =
            (0..x.len()).filter(length).map(|k| x[k].abs() * self.problem.tolerance(list[k]));
        longest.fold(0.0, f64::max)
    }
}

/// What a method found.
#[derive(Debug, Clone)]
pub struct Solution {
    /// The identified arm.
    pub state: State,
    /// Linearisations made.
    pub iterations: usize,
    /// The regularisation parameter, where there is one.
    pub lambda: Option<f64>,
    /// Whether it came to rest; one-step methods always do.
    pub settled: bool,
}

/// A method of identification.
pub trait Method: Sync {
    /// Short name, as in the paper's tables.
    fn name(&self) -> &'static str;
    /// What it does, in a line.
    fn about(&self) -> &'static str;
    /// Identifies.
    ///
    /// # Errors
    /// Where it breaks down.
    fn solve(&self, task: &Task) -> Result<Solution>;
}

/// No calibration: the nominal arm, base and tool registered.
pub struct NoCalibration;

impl Method for NoCalibration {
    fn name(&self) -> &'static str {
        "NC"
    }

    fn about(&self) -> &'static str {
        "nominal arm, base and tool registered"
    }

    fn solve(&self, task: &Task) -> Result<Solution> {
        Ok(Solution { state: task.start.clone(), iterations: 0, lambda: None, settled: true })
    }
}

/// All methods, in the order of the paper's tables.
#[must_use]
pub fn all() -> Vec<Box<dyn Method>> {
    vec![
        Box::new(NoCalibration),
        Box::new(PseudoInverse),
        Box::new(NormalEquations),
        Box::new(GradientDescent::default()),
        Box::new(GaussNewton::default()),
        Box::new(ReducedGaussNewton::default()),
        Box::new(LevenbergMarquardt::default()),
        Box::new(Kalman::default()),
        Box::new(PrintedRpim),
        Box::new(Rpim),
    ]
}

/// The ink of a method in every figure: its place in the table.
#[must_use]
pub fn ink(name: &str) -> crate::plot::Ink {
    crate::plot::Ink(all().iter().position(|method| method.name() == name).unwrap_or(0))
}
