//! The whole estimate from a set of rows: flags, lambda, fit. Everything that
//! is decided from data is decided here, so that a fold can redo all of it.

use super::folds;
use super::lambda::{LambdaChoice, LambdaRule, chosen, lambda_by};
use super::robust::{Flags, RobustFit, robust_fit, robust_fit_near};
use super::{Fit, Freedom, fit_again};
use crate::error::Result;
use crate::identify::problem::{Problem, Scaling, State};
use crate::tikhonov::Factorised;

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
    /// With it the problem at the fit, factorised for every lambda.
    pub solved: Option<Factorised>,
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
    if got_on(problem, &found) {
        // The flags and the scale are those of a place that has been left.
        let robust = robust_fit_near(&prior, rows, &found.fit.state, Flags::default())?;
        found = decided(problem, rule, robust)?;
    }
    if report {
        let kept = &found.robust.kept;
        let folds = folds::random(problem.data, kept, folds::SEED + 1);
        let (choice, solved) = chosen(problem, &found.fit.state, kept, &folds);
        (found.choice, found.solved) = (Some(choice), Some(solved));
    }
    Ok(found)
}

/// Whether the fit with another lambda went on from where the search for gross errors had
/// stayed, to a small part of what that left.
fn got_on(problem: &Problem, found: &Estimate) -> bool {
    /// Residuals over the stated noise that are worth a look.
    const FAR: f64 = 2.0;
    /// The part of a sum of squares that a change of lambda does not come to.
    const PART: f64 = 0.25;
    let robust = &found.robust;
    let left = |state: &State| -> f64 {
        let at = problem.linearise(state);
        robust.kept.iter().map(|row| at.scaled_residual(*row).norm_squared()).sum()
    };
    robust.scale > FAR && left(&found.fit.state) < PART * left(&robust.fit.state)
}

/// Lambda and the fit with it, of rows that are kept.
///
/// # Errors
/// As for [`regularised`].
pub fn decided(problem: &Problem, rule: LambdaRule, robust: RobustFit) -> Result<Estimate> {
    let (fit, lambda) = regularised(problem, rule, &robust.kept, &robust.fit)?;
    Ok(Estimate { fit, robust, lambda, choice: None, solved: None })
}

/// Linearisations for which lambda is chosen anew.
const MOST_ROUNDS: usize = 12;

/// The fit with the lambda of a rule, from the maximum a posteriori fit of the same
/// rows in the prior scaling, and that lambda.
///
/// # Errors
/// As for [`fit`](super::fit).
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
    let mut found = first.clone();
    if problem.scaling == Scaling::Printed {
        found.normal = problem.linearise(&found.state).normal(rows, None);
    }
    let mut last = f64::NAN;
    for round in 1.. {
        let lambda = lambda_by(rule, problem, &found, rows);
        found = fit_again(problem, rows, &found, Freedom::All(lambda))?;
        // Held-out poses make lambda jump by steps: no use in following it long.
        if lambda == last || (lambda / last).ln().abs() < 1e-3 || round == MOST_ROUNDS {
            return Ok((found, lambda));
        }
        last = lambda;
    }
    unreachable!("the last round returns")
}
