//! The whole estimate from a set of rows: flags, lambda, fit. Everything that
//! is decided from data is decided here, so that a fold can redo all of it.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::fit::{Fit, Freedom, fit};
use super::folds::{self, Fold};
use super::lambda::{LambdaChoice, LambdaRule, choose, lambda_by};
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
    let (fit, lambda) = regularised(problem, rule, kept, &robust.fit)?;
    let choice = report.then(|| {
        let folds = folds::random(problem.data, kept, folds::SEED + 1);
        choose(problem, &fit.state, kept, &folds)
    });
    Ok(Estimate { fit, robust, lambda, choice })
}

/// Linearisations for which lambda is chosen anew.
const MOST_ROUNDS: usize = 12;

/// The fit with the lambda of a rule, from the maximum a posteriori fit of the
/// prior scaling, and that lambda.
///
/// # Errors
/// As for [`fit`].
pub fn regularised(
    problem: &Problem,
    rule: LambdaRule,
    rows: &[usize],
    first: &Fit,
) -> Result<(Fit, f64)> {
    if (problem.scaling, rule) == (Scaling::Prior, LambdaRule::MaximumAPosteriori) {
        return Ok((first.clone(), 1.0));
    }
    // A lambda belongs to a linearisation, and that to a lambda.
    let mut state = first.state.clone();
    let mut last = f64::NAN;
    for round in 1.. {
        let lambda = lambda_by(rule, problem, &state, rows);
        let found = fit(problem, rows, None, &state, Freedom::All(lambda))?;
        // Held-out poses make lambda jump by steps: no use in following it long.
        if lambda == last || (lambda / last).ln().abs() < 1e-3 || round == MOST_ROUNDS {
            return Ok((found, lambda));
        }
        (last, state) = (lambda, found.state);
    }
    unreachable!("the last round returns")
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
