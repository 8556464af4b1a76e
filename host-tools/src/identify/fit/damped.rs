//! Damped steps (Levenberg-Marquardt) for fits that full steps do not settle:
//! the cost falls at every step, and the end is where neither the cost nor any
//! predicted measurement moves, whatever unknowns that nothing depends on do.

use nalgebra::{DMatrix, DVector};

use crate::error::{Error, ErrorKind, Result};
use crate::identify::problem::{Problem, State};
use crate::model::Values;
use crate::tikhonov::{HELD, Normal};

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
    /// Normal equations of the fitted rows at this state.
    pub normal: Normal,
    /// Gauss-Newton steps taken.
    pub steps: usize,
}

/// Steps tried, refused ones included.
const MOST_STEPS: usize = 300;
/// Damping, as a share of each unknown's own curvature: the first, its change
/// after a step that is taken and one that is refused, and where it ends.
const DAMPING: [f64; 4] = [1e-3, 0.2, 4.0, 1e9];
/// Largest step of one unknown, m or rad.
const LARGEST: f64 = 0.5;
/// Share of the cost that a step must still take off...
const LESS: f64 = 1e-9;
/// ...or RMS motion of what is predicted, in sigmas: a thousandth is nothing.
const MOVES: f64 = 1e-3;
/// Corrections beyond so many tolerances are another arm.
pub const ANOTHER_ARM: f64 = 300.0;

/// Where a fit stands.
struct Place {
    state: State,
    normal: Normal,
    /// With what holds the targets.
    held: Normal,
    x: DVector<f64>,
    cost: f64,
}

/// Fits the given rows from a state.
///
/// # Errors
/// When the end is hundreds of tolerances from nominal, or no number.
pub fn damped(
    problem: &Problem,
    rows: &[usize],
    weights: Option<&[Values]>,
    start: &State,
    freedom: Freedom,
) -> Result<Fit> {
    let place = |state: State| {
        let at = problem.linearise(&state);
        let (normal, x) = (at.normal(rows, weights), at.corrections().clone());
        let held = normal.clone().plus(&Normal::new(&problem.of_targets(&state)));
        let cost = cost(&held, &x, problem.unknowns.free(), freedom);
        Place { state, normal, held, x, cost }
    };
    let mut now = place(start.clone());
    let [mut damping, less, more, most] = DAMPING;
    for steps in 0..MOST_STEPS {
        let step = step(problem, &now, freedom, damping);
        let trial = step.and_then(|step| {
            let si = problem.linearise(&now.state).to_si(&step);
            let near = si.amax() <= LARGEST;
            let trial = near.then(|| place(now.state.stepped(&problem.unknowns, &si)))?;
            (trial.cost <= now.cost).then_some((step, trial))
        });
        let Some((step, trial)) = trial else {
            damping *= more;
            if damping > most {
                return ended(problem, now, steps);
            }
            continue;
        };
        damping *= less;
        let moved = (&step.transpose() * now.held.h() * &step)[0];
        let fell = now.cost - trial.cost;
        let settled =
            fell <= LESS * now.cost && moved <= MOVES * MOVES * now.normal.equations() as f64;
        now = trial;
        if settled {
            return ended(problem, now, steps);
        }
    }
    ended(problem, now, MOST_STEPS)
}

fn ended(problem: &Problem, place: Place, steps: usize) -> Result<Fit> {
    let far = problem.corrections(&place.state).amax();
    if place.cost.is_finite() && far < ANOTHER_ARM {
        return Ok(Fit { state: place.state, normal: place.normal, steps });
    }
    Err(Error::data(
        ErrorKind::NotConverged,
        "the identification does not converge",
        "check joint senses, units and the nominal geometry; a wrong sign of one joint is enough",
    ))
}

/// What such a fit makes least, of all unknowns at this lambda.
#[must_use]
pub fn cost_at(problem: &Problem, rows: &[usize], state: &State, lambda: f64) -> f64 {
    let at = problem.linearise(state);
    let held = at.normal(rows, None).plus(&Normal::new(&problem.of_targets(state)));
    cost(&held, at.corrections(), problem.unknowns.free(), Freedom::All(lambda))
}

/// Sum of squares and penalty at the corrections `x`.
fn cost(normal: &Normal, x: &DVector<f64>, free: usize, freedom: Freedom) -> f64 {
    let square = normal.s() - 2.0 * normal.g().dot(x) + (x.transpose() * normal.h() * x)[0];
    let penalty = match freedom {
        Freedom::All(lambda) => lambda * x.rows(free, x.len() - free).norm_squared(),
        Freedom::Frames => 0.0,
    };
    square + penalty
}

/// A damped step, in units; `None` where rounding leaves the equations indefinite.
fn step(problem: &Problem, place: &Place, freedom: Freedom, damping: f64) -> Option<DVector<f64>> {
    let free = problem.unknowns.free();
    let (n, lambda) = match freedom {
        Freedom::All(lambda) => (place.x.len(), lambda),
        Freedom::Frames => (free, 0.0),
    };
    let h = place.held.h();
    let least = HELD * HELD * h.diagonal().max().max(f64::MIN_POSITIVE);
    let mut right = place.held.g() - h * &place.x;
    let mut a: DMatrix<f64> = h.view((0, 0), (n, n)).into_owned();
    for k in 0..n {
        if k >= free {
            a[(k, k)] += lambda;
            right[k] -= lambda * place.x[k];
        }
        a[(k, k)] += (HELD + damping) * a[(k, k)].max(least);
    }
    let mut step = DVector::zeros(place.x.len());
    step.rows_mut(0, n).copy_from(&a.cholesky()?.solve(&right.rows(0, n).into_owned()));
    Some(step)
}
