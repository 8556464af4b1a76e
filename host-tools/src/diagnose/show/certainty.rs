//! How sure coefficients are: of springs, beside loads that were found with them.

use nalgebra::DMatrix;

use super::late;
use crate::diagnose::moments::Moments;
use crate::identify::Findings;
use crate::identify::problem::accumulate::{CHUNK, tree};

/// How sure a model is.
pub struct Certainty {
    /// One standard deviation of every unknown, SI.
    pub sigmas: Vec<f64>,
    /// Of the time constant with which the arm follows its temperature, s.
    pub time_constant: Option<f64>,
}

/// What is not known of masses and of how late the arm warms up included. A
/// spring half as stiff under loads twice as large bends alike: without their share a
/// coefficient would look as sure as if every mass were known.
#[must_use]
pub fn certainty(findings: &Findings, moments: Option<&Moments>) -> Certainty {
    let (problem, state) = (findings.problem, &findings.found.fit.state);
    let covariances = findings.covariances();
    let covariance = &covariances.noise + &covariances.bias;
    let mut variances = covariance.diagonal();
    if let Some(bending) = moments.and_then(|moments| moments.bending(state)) {
        let (unknowns, loads) = (covariance.nrows(), bending.found().len());
        let at = problem.linearise(state);
        // Sums of the loads' columns with those of the unknowns, and with each other.
        let leaf = |rows: &[usize]| {
            let mut coupled = DMatrix::zeros(unknowns, loads);
            let mut own = DMatrix::zeros(loads, loads);
            for row in rows {
                let e = at.equations_beside(*row, &|i, d| bending.columns(problem, i, d));
                let block = e.block.columns(unknowns, loads);
                coupled += e.block.columns(0, unknowns).tr_mul(&block);
                own += block.tr_mul(&block);
            }
            (coupled, own)
        };
        let join = |a: (DMatrix<f64>, DMatrix<f64>), b: (_, _)| (a.0 + b.0, a.1 + b.1);
        let (coupled, own) = tree(&findings.found.robust.kept, CHUNK, &leaf, &join);
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
        time_constant: late.map(|late| late.variance.sqrt()),
    }
}
