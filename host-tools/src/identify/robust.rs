//! Gross errors: found, named, and kept from bending the fit.
//!
//! First a redescending M-estimate on single coordinates, which a few wrong
//! rows cannot bend; then rows are judged by what a fit *without* them
//! predicts for them (deletion residuals), so that a row of high leverage
//! cannot hide behind its own pull.

use nalgebra::{DMatrix, Matrix3, Vector3};

use super::fit::{Fit, Freedom, fit};
use super::problem::{Linearised, Problem};
use super::unknowns::State;
use crate::error::{Error, Result};
use crate::tikhonov::covariance;

/// How flags are raised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flags {
    /// Lambda of the prior scaling.
    pub lambda: f64,
    /// A coordinate beyond this many standard deviations of what the other rows
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

/// More flagged rows than this share are no outliers but a wrong model.
const MOST_FLAGGED: f64 = 0.25;
/// With this share flagged nobody can say which rows are the others.
const MAJORITY: f64 = 0.5;

/// A flagged row.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlier {
    /// Index of the row.
    pub row: usize,
    /// Which coordinates are wrong: 0, 1, 2.
    pub coordinates: Vec<usize>,
    /// Measured minus predicted by the other rows, m.
    pub residual: Vector3<f64>,
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

/// Middle value; 0 of nothing.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => 0.0,
        n if n % 2 == 1 => sorted[n / 2],
        n => (sorted[n / 2 - 1] + sorted[n / 2]) / 2.0,
    }
}

/// Robust standard deviation of values about zero.
#[must_use]
pub fn mad_scale(values: &[f64]) -> f64 {
    1.4826 * median(&values.iter().map(|v| v.abs()).collect::<Vec<_>>())
}

/// Fits the given rows in the prior scaling, flagging gross errors.
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
    let flagged = suspects(problem, rows, start, Freedom::All(flags.lambda))?;
    refit(problem, rows, start, flagged, flags)
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

/// Rows that an M-estimate leaves far off.
fn suspects(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    fitted: Freedom,
) -> Result<Vec<usize>> {
    let mut state = start.clone();
    let mut weights = first_weights(problem, rows, start);
    let count = 3.0 * rows.len() as f64;
    let unknowns = problem.unknowns.list().len() as f64;
    let freedom = (count / (count - unknowns).max(0.25 * count)).sqrt();
    let mut flagged = Vec::new();
    for pass in 0..15 {
        state = fit(problem, rows, Some(&weights), &state, fitted)?.state;
        let at = problem.linearise(&state);
        let residuals: Vec<Vector3<f64>> =
            rows.iter().map(|r| at.residual(*r) / problem.data.rows[*r].sigma).collect();
        let flat: Vec<f64> = residuals.iter().flat_map(|r| r.iter().copied()).collect();
        let scale = (mad_scale(&flat) * freedom).max(1.0);
        let worst = |r: &Vector3<f64>| r.amax() / scale;
        flagged = rows
            .iter()
            .zip(&residuals)
            .filter(|(_, r)| worst(r) > 6.0)
            .map(|(i, _)| *i)
            .collect::<Vec<_>>();
        // Nothing stands out of a plain fit: no need for another.
        if pass == 0 && residuals.iter().all(|r| worst(r) < 5.0) {
            return Ok(Vec::new());
        }
        let mut moved = 0.0_f64;
        for (row, r) in rows.iter().zip(&residuals) {
            let new = r.map(|e| (1.0 + (e / (2.0 * scale)).powi(2)).powi(-2));
            moved = moved.max((new - weights[*row]).amax());
            weights[*row] = new;
        }
        if moved < 0.01 {
            break;
        }
    }
    // A fit needs rows; the farthest are then the suspects.
    flagged.truncate((MOST_FLAGGED * rows.len() as f64) as usize);
    Ok(flagged)
}

/// Weights for the first fit, from the registered nominal arm: a row metres off
/// must not throw the first step out of reach.
fn first_weights(problem: &Problem, rows: &[usize], start: &State) -> Vec<Vector3<f64>> {
    let at = problem.linearise(start);
    let residuals: Vec<(usize, Vector3<f64>)> =
        rows.iter().map(|r| (*r, at.residual(*r))).collect();
    let flat: Vec<f64> = residuals.iter().flat_map(|(_, r)| r.iter().copied()).collect();
    let scale = mad_scale(&flat).max(1e-9);
    let mut weights = vec![Vector3::repeat(1.0); problem.data.rows.len()];
    for (row, r) in residuals {
        weights[row] = r.map(|e| (1.0 + (e / (5.0 * scale)).powi(2)).powi(-2));
    }
    weights
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
    let cov = covariance(&fit.triangle, problem.unknowns.free(), flags.lambda);
    let mut fitted = vec![false; problem.data.rows.len()];
    kept.iter().for_each(|row| fitted[*row] = true);
    let of = |row: &usize| deletion(&at, &cov, *row, fitted[*row], problem.data.rows[*row].sigma);
    let deletions: Vec<_> = rows.iter().map(of).collect();
    let normal: Vec<f64> = rows
        .iter()
        .zip(&deletions)
        .filter(|(row, _)| fitted[**row])
        .flat_map(|(_, (e, sd))| e.component_div(sd).iter().copied().collect::<Vec<_>>())
        .collect();
    let scale = mad_scale(&normal).max(1.0);
    // Structure that the model lacks has longer tails than noise.
    let gross = if scale > 1.3 { 1.5 * flags.gross } else { flags.gross };
    let mut outliers = Vec::new();
    for (row, (e, sd)) in rows.iter().zip(&deletions) {
        let coordinates: Vec<usize> =
            (0..3).filter(|c| e[*c].abs() > gross * scale * sd[*c]).collect();
        if !coordinates.is_empty() {
            let sigma = problem.data.rows[*row].sigma;
            outliers.push(Outlier { row: *row, coordinates, residual: e * sigma });
        }
    }
    (outliers, scale)
}

/// Measured minus predicted by the other rows, and its standard deviation,
/// both in units of the row's sigma.
fn deletion(
    at: &Linearised,
    cov: &DMatrix<f64>,
    row: usize,
    kept: bool,
    sigma: f64,
) -> (Vector3<f64>, Vector3<f64>) {
    let e = at.equations(row);
    let hat: Matrix3<f64> = (&e.block * cov * e.block.transpose()).fixed_view::<3, 3>(0, 0).into();
    let residual = e.residual / sigma;
    if !kept {
        // Not in the fit: its own noise plus the prediction's.
        return (residual, (Matrix3::identity() + hat).diagonal().map(f64::sqrt));
    }
    match (Matrix3::identity() - hat).try_inverse() {
        Some(inverse) if inverse.diagonal().iter().all(|d| *d > 0.0) => {
            (inverse * residual, inverse.diagonal().map(f64::sqrt))
        }
        // The fit rests on this row alone: nothing contradicts it.
        _ => (Vector3::zeros(), Vector3::repeat(1.0)),
    }
}
