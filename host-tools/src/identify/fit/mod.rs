//! Gauss-Newton: linearise, solve the regularised problem, repeat until the
//! step no longer matters. (The paper stops after the first step.)

mod damped;
pub mod estimate;
pub mod folds;
mod l_curve_points;
mod lambda;
pub mod robust;
pub(crate) mod suspects;

use nalgebra::{DMatrix, DVector};

use super::problem::{Problem, Scaling};
use crate::error::{ErrorKind, Result};
use crate::identify::problem::{Linearised, State};
use crate::model::Values;
use crate::observations::Residual;
use crate::tikhonov::{Factorised, Normal, Triangle};

/// A step below this many tolerances (a picometre, a nanoradian) is no step.
pub const CONVERGED: f64 = 1e-6;
/// Plain Gauss-Newton steps; a problem that has not settled by then is damped.
const PLAIN_STEPS: usize = 12;
/// From this lambda on, in tolerances, normal equations are as good as a
/// triangle, and far cheaper.
const SAFE: f64 = 1e-3;

pub use damped::{ANOTHER_ARM, Fit, Freedom, cost_at, damped};
pub use l_curve_points::{LCurvePoint, l_curve};
pub use lambda::{LambdaChoice, LambdaRule, choose, lambda_of};

/// Fits the given rows from a state.
///
/// Where full steps do not settle, because two unknowns trade off or the start is
/// far, damped steps go on until nothing that was measured moves any more
/// (`damped`).
///
/// # Errors
/// When what is found is hundreds of tolerances from nominal: not this robot's
/// geometry, or not these joints.
pub fn fit(
    problem: &Problem,
    rows: &[usize],
    weights: Option<&[Values]>,
    start: &State,
    freedom: Freedom,
) -> Result<Fit> {
    fit_knowing(problem, rows, weights, start, freedom, None)
}

/// Fits the same rows, unweighted, in the same problem, from where another fit ended:
/// its sums are those of the first step.
///
/// # Errors
/// As for [`fit`].
pub fn fit_again(problem: &Problem, rows: &[usize], last: &Fit, freedom: Freedom) -> Result<Fit> {
    fit_knowing(problem, rows, None, &last.state, freedom, Some(&last.normal))
}

/// Fits rows of which the sums at the start may be known.
fn fit_knowing(
    problem: &Problem,
    rows: &[usize],
    weights: Option<&[Values]>,
    start: &State,
    freedom: Freedom,
    mut known: Option<&Normal>,
) -> Result<Fit> {
    let mut state = start.clone();
    let mut last = f64::INFINITY;
    // In the paper's units a link step counts metres, not tolerances.
    let floor = match problem.scaling {
        Scaling::Prior => CONVERGED,
        Scaling::Printed => CONVERGED * 1e-3,
    };
    for steps in 0..PLAIN_STEPS {
        let at = problem.linearise(&state);
        let targets = problem.of_targets(&state);
        let sums = || at.normal(rows, weights);
        let normal = safe(problem, freedom).then(|| known.take().cloned().unwrap_or_else(sums));
        let (step, normal) = step(problem, (&at, &targets), rows, weights, (freedom, normal));
        let size = step.amax();
        if size < floor || (steps > 3 && size < 100.0 * floor && size >= 0.5 * last) {
            return Ok(Fit { state, normal, steps });
        }
        let step = at.to_si(&step);
        if !size.is_finite() || step.amax() > 1e3 {
            break;
        }
        last = size;
        state = state.stepped(&problem.unknowns, &step);
    }
    let found = damped(problem, rows, weights, start, freedom);
    let astray = found.as_ref().is_err_and(|e| e.kind() == ErrorKind::NotConverged);
    match freedom {
        Freedom::All(lambda) if astray => {
            held_nearer(problem, rows, weights, start, lambda).map_or(found, Ok)
        }
        _ => found,
    }
}

/// The fit where links are held more firmly, as larger noise than stated would have them:
/// what many rows at few angles have in common, and no link does, is no reason to bend those
/// by hundreds of tolerances. `None` where what is left then is no noise of any kind.
fn held_nearer(
    problem: &Problem,
    rows: &[usize],
    weights: Option<&[Values]>,
    start: &State,
    lambda: f64,
) -> Option<Fit> {
    let rigid = damped(problem, rows, weights, start, Freedom::Frames).ok()?;
    let firmer = FIRMER.iter().map(|times| Freedom::All(lambda * times));
    let mut fits = firmer.map(|freedom| damped(problem, rows, weights, &rigid.state, freedom));
    let found = fits.find_map(Result::ok)?;
    let at = problem.linearise(&found.state);
    let squares: f64 = rows.iter().map(|row| at.scaled_residual(*row).norm_squared()).sum();
    let variance = squares / found.normal.equations().max(1) as f64;
    let lengths = rows.iter().map(|row| at.residual(*row)).filter(Residual::is_length);
    let (count, square) =
        lengths.fold((0.0, 0.0), |(n, sum), off| (n + 1.0, sum + off.norm().powi(2)));
    let near = count > 0.0 && square < NO_EFFECT * NO_EFFECT * count;
    (variance < NO_NOISE * NO_NOISE || near).then_some(found)
}

/// How many times as firmly links are tried to be held, one after the other.
const FIRMER: [f64; 3] = [10.0, 100.0, 1000.0];
/// Residuals beyond so many stated sigmas are a gross mistake, as diagnosis has it too...
const NO_NOISE: f64 = 50.0;
/// ...but where points are no farther off than this, m, what an arm may be off by that bends
/// (`check` has it so): sigma may be stated at a tenth of what it is, and the effects are asked next.
const NO_EFFECT: f64 = 0.02;

/// Whether normal equations, which square the condition number, are as good as a
/// triangle: where the tolerances keep it small.
pub(super) fn safe(problem: &Problem, freedom: Freedom) -> bool {
    match (problem.scaling, freedom) {
        (_, Freedom::Frames) => true,
        (Scaling::Prior, Freedom::All(lambda)) => lambda >= SAFE,
        (Scaling::Printed, Freedom::All(_)) => false,
    }
}

/// The next step in units, and the normal equations it comes from; from a triangle
/// where there are none or rounding shows in them.
fn step(
    problem: &Problem,
    (at, targets): (&Linearised, &DMatrix<f64>),
    rows: &[usize],
    weights: Option<&[Values]>,
    (freedom, normal): (Freedom, Option<Normal>),
) -> (DVector<f64>, Normal) {
    let (free, x) = (problem.unknowns.free(), at.corrections());
    if let Some(normal) = normal {
        let held = normal.clone().plus(&Normal::new(targets));
        let step = match freedom {
            // The right-hand side counts corrections from nominal; free
            // unknowns have none.
            Freedom::All(lambda) => held.solve(free, lambda).map(|solution| solution - x),
            Freedom::Frames => held.solve_free(free, x),
        };
        if let Some(step) = step {
            return (step, normal);
        }
    }
    let triangle = at.triangle(rows, weights);
    let held = match targets.is_empty() {
        true => Factorised::new(&triangle, free),
        false => {
            Factorised::new(&Triangle::join([&triangle, &Triangle::new(targets)].into_iter()), free)
        }
    };
    let step = match freedom {
        Freedom::All(lambda) => held.solve(lambda) - x,
        Freedom::Frames => held.solve_free(x),
    };
    (step, Normal::from(&triangle))
}
