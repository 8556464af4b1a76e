//! How sure a time constant is, and what its doubt makes of everything else.

use nalgebra::{DMatrix, Vector3};
use truearm::effects::Term;

use crate::diagnose::beside::{Beside, Fitted};
use crate::identify::Findings;
use crate::model::arm::{Derivatives, RowInputs};
use crate::model::{ModelTerm, Row, Warming};

/// Share of a time constant by which it is varied for a derivative.
const VARIED: f64 = 0.02;
/// One standard deviation of what an arm is warmer or colder by at the first row of a session
/// than is read there, K: an arm that has just come to rest, or to work.
const START: f64 = 1.0;
/// Of a time constant of which the data tell less than this share of what they would tell
/// alone, rounding tells the rest.
const TOLD: f64 = 1e-9;

/// A time constant beside all other unknowns.
pub struct Late {
    /// Its variance, s^2.
    pub variance: f64,
    /// What its doubt, and that of how the arm began, adds to the variance of every unknown,
    /// in units.
    pub widened: Vec<f64>,
}

/// Of an arm that follows its temperature late; none of others, and where nothing tells.
/// Columns of the time constant and of where each session began stand beside those of the
/// unknowns whose covariance is known.
#[must_use]
pub fn late(findings: &Findings, covariance: &DMatrix<f64>) -> Option<Late> {
    let (problem, state) = (findings.problem, &findings.found.fit.state);
    let tau = state.terms.iter().find_map(ModelTerm::time_constant)?;
    let sessions = sessions(&problem.data.rows);
    let (unknowns, more) = (covariance.nrows(), 1 + sessions.len());
    let columns = |i: usize, d: &Derivatives| {
        let (row, inputs) = (&problem.data.rows[i], &problem.conditions.rows[i]);
        let grown = |warmth: f64| -> Vector3<f64> {
            let inputs = RowInputs { warmth, ..RowInputs::default() };
            let late = state.terms.iter().filter_map(|term| match term {
                ModelTerm::Arm(own) if term.time_constant().is_some() => Some(own),
                _ => None,
            });
            let at_once = late.map(|own| (Term { order: 0.0, ..*own }, own.coefficient));
            at_once.map(|(t, c)| d.column(&t, &inputs, &row.q, &problem.nominal) * c).sum()
        };
        let [less, longer] = [1.0 - VARIED, 1.0 + VARIED].map(|t| inputs.warmth_at(tau * t));
        let mut out = vec![grown((longer - less) / (2.0 * VARIED * tau))];
        out.extend(sessions.iter().map(|first| match &row.warming {
            Some(own) if own.goes_on(first) => grown((-own.passed() / tau).exp()),
            _ => Vector3::zeros(),
        }));
        out
    };
    let of = Fitted::of(findings);
    let Beside { coupled, own } = of.beside(&columns, (unknowns, more));
    let moved = covariance * &coupled;
    let told = &own - coupled.tr_mul(&moved);
    let of_tau = told[(0, 0)];
    if of_tau <= TOLD * own[(0, 0)] {
        return None;
    }
    // The fit takes the arm for as warm as is read at the begin: what that is wrong by, the
    // time constant and all others take up.
    let shift = |k: usize| told[(0, k)] / of_tau;
    let starts = (1..more).map(|k| (shift(k) * START).powi(2));
    let widened = (0..unknowns).map(|u| {
        let by_start = |k: usize| ((moved[(u, k)] - moved[(u, 0)] * shift(k)) * START).powi(2);
        moved[(u, 0)].powi(2) / of_tau + (1..more).map(by_start).sum::<f64>()
    });
    Some(Late { variance: 1.0 / of_tau + starts.sum::<f64>(), widened: widened.collect() })
}

/// A reading of each session.
fn sessions(rows: &[Row]) -> Vec<Warming> {
    let mut out: Vec<Warming> = Vec::new();
    for own in rows.iter().filter_map(|row| row.warming.as_ref()) {
        if !out.iter().any(|known| known.goes_on(own)) {
            out.push(own.clone());
        }
    }
    out
}
