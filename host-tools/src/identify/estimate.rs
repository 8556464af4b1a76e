//! The whole estimate from a set of rows: flags, lambda, fit. Everything that
//! is decided from data is decided here, so that a fold can redo all of it.

use rayon::prelude::*;

use super::fit::{Fit, Freedom, fit};
use super::folds::{self, Fold};
use super::lambda::{LambdaChoice, LambdaRule, choose, lambda_by};
use super::problem::{Problem, Scaling};
use super::robust::{Flags, RobustFit, robust_fit, robust_fit_near};
use super::unknowns::State;
use crate::error::Result;
use crate::model::Row;
use crate::observations::Residual;
use crate::tikhonov::Normal;

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
    let mut found = decided(problem, rule, robust)?;
    found.choice = report.then(|| {
        let kept = &found.robust.kept;
        let folds = folds::random(problem.data, kept, folds::SEED + 1);
        choose(problem, &found.fit.state, kept, &folds)
    });
    Ok(found)
}

/// Lambda and the fit with it, of rows that are kept.
fn decided(problem: &Problem, rule: LambdaRule, robust: RobustFit) -> Result<Estimate> {
    let (fit, lambda) = regularised(problem, rule, &robust.kept, &robust.fit)?;
    Ok(Estimate { fit, robust, lambda, choice: None })
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

/// Where the estimates of folds begin: the whole less each fold's part, at the
/// weights of the whole. What a part says is thereby taken out again, to first
/// order; the fold's own passes decide the rest.
#[must_use]
pub fn without_parts(
    problem: &Problem,
    whole: &RobustFit,
    folds: &[Fold],
    lambda: f64,
) -> Vec<State> {
    let prior = Problem { scaling: Scaling::Prior, ..problem.clone() };
    let at = prior.linearise(&whole.fit.state);
    let mut kept = vec![false; prior.data.rows.len()];
    whole.kept.iter().for_each(|row| kept[*row] = true);
    let part = |fold: &Fold| {
        let rows: Vec<usize> = fold.held_out.iter().copied().filter(|r| kept[*r]).collect();
        at.normal(&rows, None)
    };
    let parts: Vec<Normal> = folds.iter().map(part).collect();
    let free = prior.unknowns.free();
    let state = |part: &Normal| {
        let left = whole.fit.normal.minus(part)?;
        let step = left.solve(free, lambda)? - at.corrections();
        let step = at.to_si(&step);
        (step.amax() < 1e3).then(|| whole.fit.state.stepped(&prior.unknowns, &step))
    };
    // Where the others say next to nothing of an unknown the difference is
    // rounding: the fold then begins where the whole ended.
    parts.iter().map(|part| state(part).unwrap_or_else(|| whole.fit.state.clone())).collect()
}

/// Measured minus predicted for every row, predicted from the other folds with
/// flags and lambda decided anew in each, from the whole less the fold. `None`
/// for a row whose station or marker the other folds do not determine.
///
/// # Errors
/// As for [`estimate`].
pub fn cross_validate(
    problem: &Problem,
    rule: LambdaRule,
    folds: &[Fold],
    whole: &Estimate,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Option<Residual>>> {
    let prior = Problem { scaling: Scaling::Prior, ..problem.clone() };
    let starts = without_parts(problem, &whole.robust, folds, Flags::default().lambda);
    let judged = folds.par_iter().zip(&starts).map(|(fold, start)| {
        let robust = robust_fit_near(&prior, &fold.fit, start, Flags::default())?;
        let found = decided(problem, rule, robust)?;
        let out = predictions(problem, fold, &found);
        progress();
        Ok(out)
    });
    let judged = judged.collect::<Vec<Result<Vec<_>>>>();
    let mut residuals = vec![None; problem.data.rows.len()];
    for fold in judged {
        for (row, residual) in fold? {
            residuals[row] = residual;
        }
    }
    Ok(residuals)
}

/// Poses of a station or marker that determine it.
const DETERMINED: usize = 3;

/// Residuals of the rows of a fold, where the estimate from the others knows
/// their station and marker.
fn predictions(problem: &Problem, fold: &Fold, found: &Estimate) -> Vec<(usize, Option<Residual>)> {
    let data = problem.data;
    let at = problem.linearise(&found.fit.state);
    let poses_of = |label: fn(&Row) -> usize, count: usize| {
        let mut poses = vec![Vec::new(); count];
        for row in found.robust.kept.iter().map(|row| &data.rows[*row]) {
            poses[label(row)].push(row.pose);
        }
        let distinct = poses.into_iter().map(|mut poses| {
            poses.sort_unstable();
            poses.dedup();
            poses.len()
        });
        distinct.collect::<Vec<usize>>()
    };
    let stations = poses_of(|row| row.station, data.stations.len());
    let markers = poses_of(|row| row.marker, data.markers.len());
    let mut seen = vec![0; data.instruments.len()];
    for row in found.robust.kept.iter().map(|row| &data.rows[*row]) {
        row.refers.iter().for_each(|i| seen[*i] += 1);
    }
    let of = |index: &usize| {
        let row = &data.rows[*index];
        let poses = stations[row.station].min(markers[row.marker]);
        let known = poses >= DETERMINED && row.refers.iter().all(|i| seen[*i] >= DETERMINED);
        (*index, known.then(|| at.residual(*index)))
    };
    fold.held_out.iter().map(of).collect()
}
