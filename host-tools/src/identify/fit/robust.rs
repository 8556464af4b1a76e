//! Gross errors: found, named, and kept from bending the fit.
//!
//! First a redescending M-estimate on single components, which a few wrong
//! rows cannot bend; then rows are judged by what a fit *without* them
//! predicts for them (deletion residuals), so that a row of high leverage
//! cannot hide behind its own pull.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::folds;
use super::suspects::{self, MOST_FLAGGED};
use super::{Fit, Freedom, fit};
use crate::error::{Error, Result};
use crate::identify::problem::accumulate::CHUNK;
use crate::identify::problem::{Linearised, Problem, State};
use crate::model::Values;
use crate::observations::{Residual, equations_of, kind};
use crate::statistics::mad_scale;
use crate::tikhonov::{covariance, used};

/// How flags are raised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flags {
    /// Lambda of the prior scaling.
    pub lambda: f64,
    /// A component beyond this many standard deviations of what the other rows
    /// predict is a gross error; half as many again where the residuals are well
    /// above the stated noise.
    pub gross: f64,
    /// What to do where more rows are flagged than can be gross errors.
    pub crowd: Crowd,
}

/// What to do with more flagged rows than can be gross errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crowd {
    /// An error.
    Refused,
    /// They stay flagged while the others are the majority; else no row is.
    Described,
}

impl Default for Flags {
    /// Beyond doubt: at 18 poses chance passes 8 once in a hundred million, and
    /// honest rows of a coarse model stay below 6.
    fn default() -> Self {
        Self { lambda: 1.0, gross: 8.0, crowd: Crowd::Refused }
    }
}

impl Flags {
    /// Standard deviations of residuals of this scale beyond which a component is wrong:
    /// structure that the model lacks has longer tails than noise.
    #[must_use]
    pub fn limit(&self, scale: f64) -> f64 {
        if scale > 1.3 { 1.5 * self.gross } else { self.gross }
    }
}

/// With this share flagged nobody can say which rows are the others.
const MAJORITY: f64 = 0.5;

/// A flagged row.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlier {
    /// Index of the row.
    pub row: usize,
    /// Which components of its kind are wrong.
    pub components: Vec<&'static str>,
    /// Measured minus predicted by the other rows, SI.
    pub residual: Residual,
}

/// A fit that gross errors did not bend.
#[derive(Debug, Clone)]
pub struct RobustFit {
    /// The fit of the rows that were kept.
    pub fit: Fit,
    /// Rows kept.
    pub kept: Vec<usize>,
    /// Rows flagged.
    pub outliers: Vec<Outlier>,
    /// Standard deviation of a normalised residual: 1 when the model is good to
    /// the noise, more when structure is left. Never below 1.
    pub scale: f64,
    /// Equations that the fit has used up: as many as there are unknowns that the data decide
    /// and the prior does not.
    pub used: f64,
}

/// Fits the given rows in the prior scaling, flagging gross errors. `start` is
/// a registered arm, maybe nominal: first weights withstand its errors. Of many rows
/// some are fitted first; the flags of all are decided by all.
///
/// # Errors
/// As for [`fit`], or [`ErrorKind::Contradiction`](crate::ErrorKind::Contradiction) when so many rows disagree that
/// none can be called wrong.
pub fn robust_fit(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    flags: Flags,
) -> Result<RobustFit> {
    let sampled = folds::sample(problem.data, rows)
        .and_then(|some| from_all(problem, &some, start, flags).ok())
        .map(|near| (judge(problem, &near.fit, rows, &near.kept, flags).0, near.fit.state));
    match sampled {
        Some((outliers, near)) if outliers.len() as f64 <= MOST_FLAGGED * rows.len() as f64 => {
            let flagged = outliers.iter().map(|o| o.row).collect();
            refit(problem, rows, &near, flagged, flags)
        }
        _ => from_all(problem, rows, start, flags),
    }
}

/// The same by passes over all rows from the start on.
pub(in crate::identify) fn from_all(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    flags: Flags,
) -> Result<RobustFit> {
    let flagged = suspects::far_from(problem, rows, start, flags.lambda)?;
    refit(problem, rows, start, flagged, flags)
}

/// The same from a fit to nearly the same rows, or what is left of it without
/// the others: no row is flagged because it was.
///
/// # Errors
/// As for [`robust_fit`].
pub fn robust_fit_near(
    problem: &Problem,
    rows: &[usize],
    near: &State,
    flags: Flags,
) -> Result<RobustFit> {
    let flagged = suspects::near(problem, rows, near, flags.lambda)?;
    refit(problem, rows, near, flagged, flags)
}

/// The same from rows already suspected, near a fit.
fn refit(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    flagged: Vec<usize>,
    flags: Flags,
) -> Result<RobustFit> {
    let mut start = start.clone();
    settle(problem, rows, flagged, flags, &mut |kept| {
        let found = fit(problem, kept, None, &start, Freedom::All(flags.lambda))?;
        start = found.state.clone();
        Ok(found)
    })
}

/// Fits the rows that are not suspected and judges all of them by what the others
/// predict, until the same ones are flagged again.
///
/// # Errors
/// Those of the fit, and for [`robust_fit`]'s reasons.
pub fn settle(
    problem: &Problem,
    rows: &[usize],
    mut flagged: Vec<usize>,
    flags: Flags,
    fit: &mut dyn FnMut(&[usize]) -> Result<Fit>,
) -> Result<RobustFit> {
    let mut seen: Vec<Vec<usize>> = Vec::new();
    let mut before: Vec<Outlier> = Vec::new();
    loop {
        let mut suspected = vec![false; problem.data.rows.len()];
        flagged.iter().for_each(|row| suspected[*row] = true);
        let kept: Vec<usize> = rows.iter().copied().filter(|row| !suspected[*row]).collect();
        let found = fit(&kept)?;
        let (outliers, scale, used) = judge(problem, &found, rows, &kept, flags);
        let next: Vec<usize> = outliers.iter().map(|o| o.row).collect();
        let share = next.len() as f64 / rows.len() as f64;
        match flags.crowd {
            Crowd::Refused if share > MOST_FLAGGED => {
                return Err(Error::contradiction(next.len(), rows.len()));
            }
            Crowd::Described if share > MAJORITY => {
                let found = fit(rows)?;
                let (_, scale, used) = judge(problem, &found, rows, rows, flags);
                let kept = rows.to_vec();
                return Ok(RobustFit { fit: found, kept, outliers: Vec::new(), scale, used });
            }
            _ => {}
        }
        if next == flagged {
            return Ok(RobustFit { fit: found, kept, outliers, scale, used });
        }
        // Going round in circles: the flags that this fit was without.
        if seen.contains(&next) {
            return Ok(RobustFit { fit: found, kept, outliers: before, scale, used });
        }
        before = outliers;
        seen.push(std::mem::replace(&mut flagged, next));
    }
}

/// Tests every row against what the fit without it predicts: gross ones, the scale of the
/// others, and equations that the fit has used up.
fn judge(
    problem: &Problem,
    fit: &Fit,
    rows: &[usize],
    kept: &[usize],
    flags: Flags,
) -> (Vec<Outlier>, f64, f64) {
    let at = problem.linearise(&fit.state);
    let cov = covariance(&fit.normal, problem.unknowns.free(), flags.lambda);
    let mut fitted = vec![false; problem.data.rows.len()];
    kept.iter().for_each(|row| fitted[*row] = true);
    let of = |chunk: &[usize]| deletions(problem, &at, &cov, chunk, &fitted);
    let over_sd = |(e, sd): (Values, Values)| e.zip_map(&sd, |e, sd| e / sd);
    let own = |chunk: &[usize]| of(chunk).into_iter().map(over_sd).collect();
    let deletions: Vec<Vec<Values>> = rows.par_chunks(CHUNK).map(own).collect();
    let deletions = || rows.iter().zip(deletions.iter().flatten());
    let mut normal = Vec::with_capacity(problem.equations(kept));
    for (_, e) in deletions().filter(|(row, _)| fitted[**row]) {
        normal.extend_from_slice(e);
    }
    let scale = mad_scale(&normal).max(1.0);
    let gross = flags.limit(scale);
    let mut outliers = Vec::new();
    for (row, e) in deletions().filter(|(_, e)| e.amax() > gross * scale) {
        let own = &problem.data.rows[*row];
        let names = kind(own).components().iter().zip(e.iter());
        let wrong = names.filter(|(_, e)| e.abs() > gross * scale);
        let components = wrong.map(|(name, _)| *name).collect();
        let (left, _) = of(&[*row])[0];
        let residual = Residual::new(own, left.zip_map(&problem.scale(*row), |e, s| e * s));
        outliers.push(Outlier { row: *row, components, residual });
    }
    (outliers, scale, used(&fit.normal, &cov))
}

/// Of each row, measured minus predicted by the other rows, and its standard
/// deviation, both in units of the row's equations.
fn deletions(
    problem: &Problem,
    at: &Linearised,
    cov: &DMatrix<f64>,
    rows: &[usize],
    fitted: &[bool],
) -> Vec<(Values, Values)> {
    let columns = at.columns(rows, None);
    let unknowns = cov.nrows();
    let (a, b) = (columns.rows(0, unknowns), columns.row(unknowns));
    let weighed = cov * columns.rows(0, unknowns);
    let mut first = 0;
    let of = |row: &usize| {
        let own = first;
        first += equations_of(&problem.data.rows[*row]);
        let hat = |i: usize, j: usize| a.column(own + i).dot(&weighed.column(own + j));
        let hat = DMatrix::from_fn(first - own, first - own, hat);
        let left = |c: usize| b[own + c] - a.column(own + c).dot(at.corrections());
        deletion(&Values::from_fn(first - own, left), hat, fitted[*row])
    };
    rows.iter().map(of).collect()
}

/// The same of a row with this residual and this block of the hat matrix.
fn deletion(residual: &Values, hat: DMatrix<f64>, kept: bool) -> (Values, Values) {
    let count = residual.len();
    if !kept {
        // Not in the fit: its own noise plus the prediction's.
        return (*residual, Values::from_fn(count, |c| (1.0 + hat[(c, c)]).sqrt()));
    }
    match (DMatrix::identity(count, count) - hat).try_inverse() {
        Some(inverse) if inverse.diagonal().iter().all(|d| *d > 0.0) => {
            let left = &inverse * residual.column();
            let sd = Values::from_fn(count, |c| inverse[(c, c)].sqrt());
            (left.iter().copied().collect(), sd)
        }
        // The fit rests on this row alone: nothing contradicts it.
        _ => (Values::repeat(count, 0.0), Values::repeat(count, 1.0)),
    }
}
