//! Rows that may be gross errors: a redescending M-estimate on single
//! components, which a few wrong rows cannot bend.

use rayon::prelude::*;

use super::{Freedom, fit};
use crate::error::Result;
use crate::identify::problem::{Problem, State};
use crate::model::Values;
use crate::statistics::mad_scale;

/// More flagged rows than this share are no outliers but a wrong model.
pub(crate) const MOST_FLAGGED: f64 = 0.25;
/// Residuals in sigmas where nothing stands out, over their scale.
const PLAIN: f64 = 5.0;
/// The same of a row that is suspected.
const SUSPECT: f64 = 6.0;

/// Residuals of rows in sigmas, and their scale, never below 1.
fn scaled(problem: &Problem, rows: &[usize], state: &State) -> (Vec<Values>, f64) {
    let at = problem.linearise(state);
    let residuals: Vec<Values> = rows.par_iter().map(|row| at.scaled_residual(*row)).collect();
    let flat: Vec<f64> = residuals.iter().flat_map(|r| r.to_vec()).collect();
    let (count, unknowns) = (flat.len() as f64, problem.unknowns.list().len() as f64);
    let freedom = (count / (count - unknowns).max(0.25 * count)).sqrt();
    (residuals, (mad_scale(&flat) * freedom).max(1.0))
}

/// Weight 1 for every equation of the file.
fn ones(problem: &Problem) -> Vec<Values> {
    (0..problem.data.rows.len()).map(|row| problem.scale(row).map(|_| 1.0)).collect()
}

/// Redescending weights of residuals; the largest change of one.
fn weigh(weights: &mut [Values], rows: &[usize], residuals: &[Values], scale: f64) -> f64 {
    let mut moved = 0.0_f64;
    for (row, r) in rows.iter().zip(residuals) {
        let new = r.map(|e| (1.0 + (e / (2.0 * scale)).powi(2)).powi(-2));
        moved = moved.max((new - weights[*row]).amax());
        weights[*row] = new;
    }
    moved
}

/// Rows that an M-estimate leaves far off, from a state that is far from a fit.
///
/// # Errors
/// As for [`fit`].
pub fn far_from(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    lambda: f64,
) -> Result<Vec<usize>> {
    suspects(problem, rows, start, first_weights(problem, rows, start), lambda)
}

/// The same from a state that is near a fit.
///
/// # Errors
/// As for [`fit`].
pub fn near(problem: &Problem, rows: &[usize], near: &State, lambda: f64) -> Result<Vec<usize>> {
    let (residuals, scale) = scaled(problem, rows, near);
    if residuals.iter().all(|r| r.amax() < PLAIN * scale) {
        return Ok(Vec::new());
    }
    let mut weights = ones(problem);
    weigh(&mut weights, rows, &residuals, scale);
    suspects(problem, rows, near, weights, lambda)
}

fn suspects(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    mut weights: Vec<Values>,
    lambda: f64,
) -> Result<Vec<usize>> {
    let mut state = start.clone();
    let mut far: Vec<(usize, f64)> = Vec::new();
    for pass in 0..15 {
        state = fit(problem, rows, Some(&weights), &state, Freedom::All(lambda))?.state;
        let (residuals, scale) = scaled(problem, rows, &state);
        let each = rows.iter().copied().zip(residuals.iter().map(Values::amax));
        far = each.filter(|(_, most)| most / scale > SUSPECT).collect();
        // Nothing stands out of a plain fit: no need for another.
        if pass == 0 && residuals.iter().all(|r| r.amax() < PLAIN * scale) {
            return Ok(Vec::new());
        }
        if weigh(&mut weights, rows, &residuals, scale) < 0.01 {
            break;
        }
    }
    // A fit needs rows; the farthest are then the suspects.
    far.sort_by(|a, b| b.1.total_cmp(&a.1));
    far.truncate((MOST_FLAGGED * rows.len() as f64) as usize);
    let mut flagged: Vec<usize> = far.into_iter().map(|(row, _)| row).collect();
    flagged.sort_unstable();
    Ok(flagged)
}

/// Weights for the first fit, from the registered nominal arm: a row metres off
/// must not throw the first step out of reach.
fn first_weights(problem: &Problem, rows: &[usize], start: &State) -> Vec<Values> {
    let (residuals, _) = scaled(problem, rows, start);
    let flat: Vec<f64> = residuals.iter().flat_map(|r| r.to_vec()).collect();
    let scale = mad_scale(&flat).max(1e-3);
    let mut weights = ones(problem);
    for (row, r) in rows.iter().zip(&residuals) {
        weights[*row] = r.map(|e| (1.0 + (e / (5.0 * scale)).powi(2)).powi(-2));
    }
    weights
}
