//! Gross errors: found, named, and kept from bending the fit.
//!
//! First a redescending M-estimate on single components, which a few wrong
//! rows cannot bend; then rows are judged by what a fit *without* them
//! predicts for them (deletion residuals), so that a row of high leverage
//! cannot hide behind its own pull.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::fit::{Fit, Freedom, fit};
use super::linearised::Linearised;
use super::problem::Problem;
use super::suspects::{self, MOST_FLAGGED};
use super::unknowns::State;
use crate::error::{Error, Result};
use crate::model::Values;
use crate::observations::{Residual, kind};
use crate::statistics::mad_scale;
use crate::tikhonov::covariance;

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
}

/// Fits the given rows in the prior scaling, flagging gross errors. `start` is
/// a registered arm, maybe nominal: first weights withstand its errors.
///
/// # Errors
/// As for [`fit`], or [`Kind::Contradiction`](crate::Kind::Contradiction) when so many rows disagree that
/// none can be called wrong.
pub fn robust_fit(
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
///
/// # Errors
/// As for [`robust_fit`].
pub fn refit(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    mut flagged: Vec<usize>,
    flags: Flags,
) -> Result<RobustFit> {
    let freedom = Freedom::All(flags.lambda);
    let mut start = start.clone();
    let mut seen: Vec<Vec<usize>> = Vec::new();
    loop {
        let kept: Vec<usize> = rows.iter().copied().filter(|r| !flagged.contains(r)).collect();
        let fit = fit(problem, &kept, None, &start, freedom)?;
        start = fit.state.clone();
        let (outliers, scale) = judge(problem, &fit, rows, &kept, flags);
        let next: Vec<usize> = outliers.iter().map(|o| o.row).collect();
        let share = next.len() as f64 / rows.len() as f64;
        match flags.crowd {
            Crowd::Refused if share > MOST_FLAGGED => {
                return Err(Error::contradiction(next.len(), rows.len()));
            }
            Crowd::Described if share > MAJORITY => {
                let fit = self::fit(problem, rows, None, &start, freedom)?;
                let (_, scale) = judge(problem, &fit, rows, rows, flags);
                return Ok(RobustFit { fit, kept: rows.to_vec(), outliers: Vec::new(), scale });
            }
            _ => {}
        }
        // Settled, or going round in circles: then keep the last flags.
        if next == flagged || seen.contains(&next) {
            return Ok(RobustFit { fit, kept, outliers, scale });
        }
        seen.push(std::mem::replace(&mut flagged, next));
    }
}

/// Tests every row against what the fit without it predicts.
fn judge(
    problem: &Problem,
    fit: &Fit,
    rows: &[usize],
    kept: &[usize],
    flags: Flags,
) -> (Vec<Outlier>, f64) {
    let at = problem.linearise(&fit.state);
    let cov = covariance(&fit.normal, problem.unknowns.free(), flags.lambda);
    let mut fitted = vec![false; problem.data.rows.len()];
    kept.iter().for_each(|row| fitted[*row] = true);
    let of = |row: &usize| deletion(&at, &cov, *row, fitted[*row]);
    let deletions: Vec<_> = rows.par_iter().map(of).collect();
    let normal: Vec<f64> = rows
        .iter()
        .zip(&deletions)
        .filter(|(row, _)| fitted[**row])
        .flat_map(|(_, (e, sd))| e.zip_map(sd, |e, sd| e / sd).to_vec())
        .collect();
    let scale = mad_scale(&normal).max(1.0);
    // Structure that the model lacks has longer tails than noise.
    let gross = if scale > 1.3 { 1.5 * flags.gross } else { flags.gross };
    let mut outliers = Vec::new();
    for (row, (e, sd)) in rows.iter().zip(&deletions) {
        let of = &problem.data.rows[*row];
        let names = kind(of).components().iter().enumerate();
        let wrong = names.filter(|(c, _)| e[*c].abs() > gross * scale * sd[*c]);
        let components: Vec<&'static str> = wrong.map(|(_, name)| *name).collect();
        if !components.is_empty() {
            let residual = Residual::new(of, e.zip_map(&problem.scale(*row), |e, s| e * s));
            outliers.push(Outlier { row: *row, components, residual });
        }
    }
    (outliers, scale)
}

/// Measured minus predicted by the other rows, and its standard deviation,
/// both in units of the row's equations.
fn deletion(at: &Linearised, cov: &DMatrix<f64>, row: usize, kept: bool) -> (Values, Values) {
    let e = at.equations(row);
    let hat = &e.block * cov * e.block.transpose();
    let residual = e.scaled_residual();
    let count = residual.len();
    if !kept {
        // Not in the fit: its own noise plus the prediction's.
        return (residual, Values::from_fn(count, |c| (1.0 + hat[(c, c)]).sqrt()));
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
