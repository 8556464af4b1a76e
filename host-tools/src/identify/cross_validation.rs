//! Rows judged by the estimate from the others: a fold is the whole less its part
//! at common weights, then a pass of that fold with its own flags and weights.

use nalgebra::DVector;
use rayon::prelude::*;

use super::fit::{Fit, Freedom, safe};
use super::problem::{Problem, Scaling};
use crate::error::{Error, ErrorKind, Result};
use crate::identify::fit::estimate::{Estimate, decided};
use crate::identify::fit::folds::Fold;
use crate::identify::fit::robust::{Flags, RobustFit, robust_fit_near, settle};
use crate::identify::fit::{LambdaRule, lambda_of};
use crate::identify::problem::{Linearised, State};
use crate::model::Row;
use crate::observations::Residual;
use crate::tikhonov::Normal;

/// RMS motion of what is predicted, over the scale of the residuals, below which a
/// fold is as good as linear in its distance from the whole. Second order is then
/// below a hundredth of that motion: ten-thousandths of a residual, and its square of
/// what is held out (`docs/results.md`, Time and memory).
const NEAR: f64 = 0.03;

/// A whole in the prior scaling and what each fold's part of it says.
pub struct Parts<'a> {
    problem: Problem<'a>,
    /// The whole.
    fit: Fit,
    at: Linearised<'a>,
    /// Scale of its residuals.
    scale: f64,
    /// Rows that it kept, of all rows.
    kept: Vec<bool>,
    folds: &'a [Fold],
    /// Sums of the rows kept of each fold's part, at the whole's state.
    parts: Vec<Normal>,
    /// What holds the targets.
    targets: Normal,
}

impl<'a> Parts<'a> {
    /// Of a fit to the rows that flags left.
    #[must_use]
    pub fn new(problem: &Problem<'a>, fit: &Fit, flags: &RobustFit, folds: &'a [Fold]) -> Self {
        let problem = Problem { scaling: Scaling::Prior, ..problem.clone() };
        let at = problem.linearise(&fit.state);
        let mut kept = vec![false; problem.data.rows.len()];
        flags.kept.iter().for_each(|row| kept[*row] = true);
        let part = |fold: &Fold| {
            let rows: Vec<usize> = fold.held_out.iter().copied().filter(|r| kept[*r]).collect();
            at.normal(&rows, None)
        };
        let parts = folds.iter().map(part).collect();
        let targets = Normal::new(&problem.of_targets(&fit.state));
        Self { fit: fit.clone(), at, scale: flags.scale, kept, folds, parts, targets, problem }
    }

    /// Sums of the others of a fold.
    fn others(&self, fold: usize) -> Option<Normal> {
        self.fit.normal.minus(&self.parts[fold])
    }

    /// The step from the whole to the solution of some sums, in units.
    fn step(&self, sums: &Normal, lambda: f64) -> Option<DVector<f64>> {
        let held = sums.clone().plus(&self.targets);
        let step = held.solve(self.problem.unknowns.free(), lambda)? - self.at.corrections();
        (self.at.to_si(&step).amax() < 1e3).then_some(step)
    }

    fn stepped(&self, step: &DVector<f64>) -> State {
        self.fit.state.stepped(&self.problem.unknowns, &self.at.to_si(step))
    }

    /// Where the estimate of a fold begins. What its part says is thereby taken out
    /// again, to first order; the fold's own passes decide the rest.
    #[must_use]
    pub fn start(&self, fold: usize, lambda: f64) -> State {
        let step = self.others(fold).and_then(|others| self.step(&others, lambda));
        // Where the others say next to nothing of an unknown the difference is
        // rounding: the fold then begins where the whole ended.
        step.map_or_else(|| self.fit.state.clone(), |step| self.stepped(&step))
    }

    /// The fit of a fold's others with flags of its own.
    ///
    /// # Errors
    /// As for [`robust_fit_near`].
    pub fn robust(&self, fold: usize, flags: Flags) -> Result<RobustFit> {
        if let Some(Ok(found)) = self.linear(fold, flags, flags.lambda) {
            return Ok(found);
        }
        let start = self.start(fold, flags.lambda);
        robust_fit_near(&self.problem, &self.folds[fold].fit, &start, flags)
    }

    /// The same from the whole's linearisation, where it is near: its own flags change
    /// its sums by the rows that only the whole or only the fold keeps. `near` is the
    /// lambda that the whole was fitted with.
    fn linear(&self, fold: usize, flags: Flags, near: f64) -> Option<Result<RobustFit>> {
        let others = self.others(fold)?;
        let step = self.step(&others, near)?;
        let moved = step.dot(&(self.fit.normal.h() * &step));
        if moved > (NEAR * self.scale).powi(2) * self.fit.normal.equations() as f64 {
            return None;
        }
        let rows = &self.folds[fold].fit;
        let flagged = rows.iter().copied().filter(|row| !self.kept[*row]).collect();
        Some(settle(&self.problem, rows, flagged, flags, &mut |kept| {
            let mut keeps = vec![false; self.kept.len()];
            kept.iter().for_each(|row| keeps[*row] = true);
            let only = |of: &[bool], other: &[bool]| -> Vec<usize> {
                rows.iter().copied().filter(|row| of[*row] && !other[*row]).collect()
            };
            let more = self.at.normal(&only(&keeps, &self.kept), None);
            let less = self.at.normal(&only(&self.kept, &keeps), None);
            let normal = others.clone().plus(&more).minus(&less).ok_or_else(indefinite)?;
            let step = self.step(&normal, flags.lambda).ok_or_else(indefinite)?;
            Ok(Fit { state: self.stepped(&step), normal, steps: 1 })
        }))
    }

    /// The whole estimate of a fold's others in the prior scaling from the whole's
    /// linearisation; `None` where that is not near, or not all that is asked for.
    pub(super) fn estimate(&self, fold: usize, rule: LambdaRule, near: f64) -> Option<Estimate> {
        let robust = self.linear(fold, Flags::default(), near)?.ok()?;
        let lambda = lambda_of(rule, &robust.fit.normal, self.problem.unknowns.free())?;
        if !safe(&self.problem, Freedom::All(lambda)) {
            return None;
        }
        let state = self.stepped(&self.step(&robust.fit.normal, lambda)?);
        let fit = Fit { state, ..robust.fit.clone() };
        Some(Estimate { fit, robust, lambda, choice: None, solved: None })
    }
}

/// Sums that rounding has left indefinite.
fn indefinite() -> Error {
    Error::data(ErrorKind::NotConverged, "the sums of a fold are indefinite", "measure more poses")
}

/// Measured minus predicted for every row, predicted from the other folds with
/// flags and lambda decided anew in each, from the whole less the fold. `None`
/// for a row whose station or marker the other folds do not determine.
///
/// # Errors
/// As for [`estimate`](crate::identify::fit::estimate::estimate).
pub fn cross_validate(
    problem: &Problem,
    rule: LambdaRule,
    folds: &[Fold],
    whole: &Estimate,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Option<Residual>>> {
    // Where lambda hardly holds the whole it is no place to begin.
    let held = safe(problem, Freedom::All(whole.lambda));
    let fit = if held { &whole.fit } else { &whole.robust.fit };
    let parts = Parts::new(problem, fit, &whole.robust, folds);
    let judged = (0..folds.len()).into_par_iter().map(|k| {
        let near = held.then(|| parts.estimate(k, rule, whole.lambda)).flatten();
        let found = match near {
            Some(found) => found,
            None => {
                let start = parts.start(k, Flags::default().lambda);
                let fold = &folds[k].fit;
                let robust = robust_fit_near(&parts.problem, fold, &start, Flags::default())?;
                decided(problem, rule, robust)?
            }
        };
        let out = predictions(problem, &folds[k], &found);
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
