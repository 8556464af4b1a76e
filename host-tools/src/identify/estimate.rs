//! The whole estimate from a set of rows: flags, lambda, fit. Everything that
//! is decided from data is decided here, so that a fold can redo all of it.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::fit::{Fit, Freedom, fit};
use super::folds::{self, Fold};
use super::lambda::{LambdaChoice, LambdaRule, choose};
use super::problem::{Problem, Scaling};
use super::robust::{Flags, RobustFit, robust_fit};
use super::unknowns::State;
use crate::error::Result;

/// An estimate.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// The fit with the chosen lambda.
    pub fit: Fit,
    /// The flags.
    pub robust: RobustFit,
    /// The lambda used.
    pub lambda: f64,
    /// What the rules say, if they were asked.
    pub choice: Option<LambdaChoice>,
}

/// Estimates from the given rows. With `report` the lambda rules are computed
/// even where the rule in force needs none of them.
///
/// # Errors
/// As for [`robust_fit`].
pub fn estimate(
    problem: &Problem,
    rule: LambdaRule,
    rows: &[usize],
    start: &State,
    report: bool,
) -> Result<Estimate> {
    let prior = Problem { scaling: Scaling::Prior, ..problem.clone() };
    let robust = robust_fit(&prior, rows, start, Flags::default())?;
    let kept = &robust.kept;
    let ask = |state: &State| {
        choose(problem, state, kept, &folds::random(problem.data, kept, folds::SEED + 1))
    };
    let settled = match (problem.scaling, rule) {
        (Scaling::Prior, LambdaRule::MaximumAPosteriori) => Some(1.0),
        (_, LambdaRule::Fixed(lambda)) => Some(lambda),
        _ => None,
    };
    if let Some(lambda) = settled {
        let converged = if problem.scaling == Scaling::Prior && lambda == 1.0 {
            robust.fit.clone()
        } else {
            fit(problem, kept, None, start, Freedom::All(lambda))?
        };
        let choice = report.then(|| ask(&converged.state));
        return Ok(Estimate { fit: converged, robust, lambda, choice });
    }
    // The curve belongs to a linearisation, and that to a lambda.
    let mut state = robust.fit.state.clone();
    let mut last = f64::NAN;
    loop {
        let choice = ask(&state);
        let lambda = choice.by(rule);
        let converged = fit(problem, kept, None, &state, Freedom::All(lambda))?;
        if (lambda / last).ln().abs() < 0.02 || !last.is_nan() {
            return Ok(Estimate { fit: converged, robust, lambda, choice: Some(choice) });
        }
        (last, state) = (lambda, converged.state);
    }
}

/// Measured minus predicted for every row, predicted from the other folds with
/// flags and lambda decided anew in each. `None` for a row whose station or
/// marker the other folds do not determine.
///
/// # Errors
/// As for [`estimate`].
pub fn cross_validate(
    problem: &Problem,
    rule: LambdaRule,
    folds: &[Fold],
    start: &State,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Option<Vector3<f64>>>> {
    let data = problem.data;
    let judged = folds.par_iter().map(|fold| {
        let estimate = estimate(problem, rule, &fold.fit, start, false)?;
        let at = problem.linearise(&estimate.fit.state);
        let seen = |f: &dyn Fn(usize) -> bool| {
            let mut poses: Vec<_> = estimate
                .robust
                .kept
                .iter()
                .filter(|r| f(**r))
                .map(|r| data.rows[*r].pose)
                .collect();
            poses.sort_unstable();
            poses.dedup();
            poses.len()
        };
        let known = |row: usize| {
            let (station, marker) = (data.rows[row].station, data.rows[row].marker);
            seen(&|r| data.rows[r].station == station) >= 3
                && seen(&|r| data.rows[r].marker == marker) >= 3
        };
        // Looked up once a pair, not once a row.
        let mut pairs: Vec<((usize, usize), bool)> = Vec::new();
        let mut out = Vec::new();
        for row in &fold.held_out {
            let pair = (data.rows[*row].station, data.rows[*row].marker);
            let usable = match pairs.iter().find(|(p, _)| *p == pair) {
                Some((_, usable)) => *usable,
                None => {
                    pairs.push((pair, known(*row)));
                    known(*row)
                }
            };
            out.push((*row, usable.then(|| at.residual(*row))));
        }
        progress();
        Ok(out)
    });
    let judged = judged.collect::<Vec<Result<Vec<_>>>>();
    let mut residuals = vec![None; data.rows.len()];
    for fold in judged {
        for (row, residual) in fold? {
            residuals[row] = residual;
        }
    }
    Ok(residuals)
}
