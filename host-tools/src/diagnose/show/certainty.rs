//! How sure coefficients are: of springs, beside loads that were found with them.

use nalgebra::DMatrix;

use super::late;
use crate::diagnose::beside::{Beside, Fitted};
use crate::diagnose::moments::Moments;
use crate::diagnose::orders::{self, Line};
use crate::identify::Findings;
use crate::model::ModelTerm;
use crate::model::arm::Derivatives;

/// How sure a model is.
pub struct Certainty {
    /// One standard deviation of every unknown, SI.
    pub sigmas: Vec<f64>,
    /// Of the time constant with which the arm follows its temperature, s.
    pub time_constant: Option<f64>,
    /// Of the orders of lines.
    pub lines: Vec<Line>,
}

impl Certainty {
    /// One standard deviation of the order of the line that a term is of, cycles a turn.
    #[must_use]
    pub fn of_order(&self, term: &ModelTerm) -> Option<f64> {
        let line = self.lines.iter().find(|line| line.has(term))?;
        Some(line.sigma).filter(|sigma| sigma.is_finite())
    }
}

/// What is not known of masses and of how late the arm warms up included. A
/// spring half as stiff under loads twice as large bends alike: without their share a
/// coefficient would look as sure as if every mass were known.
#[must_use]
pub fn certainty(findings: &Findings, moments: Option<&Moments>) -> Certainty {
    let (problem, state) = (findings.problem, &findings.found.fit.state);
    let of = Fitted::of(findings);
    let covariances = findings.covariances();
    let covariance = &covariances.noise + &covariances.bias;
    let mut variances = covariance.diagonal();
    if let Some(bending) = moments.and_then(|moments| moments.bending(state)) {
        let (unknowns, loads) = (covariance.nrows(), bending.found().len());
        let columns = |i: usize, d: &Derivatives| bending.columns(problem, i, d);
        let Beside { coupled, own } = of.beside(&columns, (unknowns, loads));
        // The inverse of both together, by Schur's complement; a unit of a load is one
        // standard deviation of what is believed of it.
        let spread = &covariance * &coupled;
        let open = DMatrix::identity(loads, loads) + own - coupled.tr_mul(&spread);
        if let Some(factor) = open.cholesky() {
            let solved = factor.solve(&spread.transpose());
            for (u, variance) in variances.iter_mut().enumerate() {
                *variance += spread.row(u).transpose().dot(&solved.column(u));
            }
        }
    }
    let late = late::late(findings, &covariance);
    if let Some(late) = &late {
        variances.iter_mut().zip(&late.widened).for_each(|(own, more)| *own += more);
    }
    let sigma = |(v, unit): (&f64, &f64)| v.max(0.0).sqrt() * unit;
    Certainty {
        sigmas: variances.iter().zip(&problem.units()).map(sigma).collect(),
        lines: orders::lines(&of, &covariance),
        time_constant: late.map(|late| late.variance.sqrt()),
    }
}
