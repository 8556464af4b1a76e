//! How sure coefficients are: of springs, beside loads that were found with them.

use nalgebra::{DMatrix, DVector, Vector3};

use crate::diagnose::moments::Moments;
use crate::identify::Findings;
use crate::identify::problem::accumulate::{CHUNK, tree};
use crate::model::ModelTerm;
use crate::model::arm::Derivatives;

/// Share of a time constant by which it is varied for a derivative.
const VARIED: f64 = 0.02;

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
    let late = late(findings, &covariance);
    if let Some((variance, moved)) = &late {
        for (own, moved) in variances.iter_mut().zip(moved.iter()) {
            *own += moved * moved * variance;
        }
    }
    let sigma = |(v, unit): (&f64, &f64)| v.max(0.0).sqrt() * unit;
    Certainty {
        sigmas: variances.iter().zip(&problem.units()).map(sigma).collect(),
        time_constant: late.map(|(variance, _)| variance.sqrt()),
    }
}

/// The variance of the arm's time constant, s^2, all unknowns free beside it, and how these
/// move with it; none of an arm that follows its temperature at once.
fn late(findings: &Findings, covariance: &DMatrix<f64>) -> Option<(f64, DVector<f64>)> {
    let (problem, state) = (findings.problem, &findings.found.fit.state);
    let tau = state.terms.iter().find_map(ModelTerm::time_constant)?;
    let unknowns = covariance.nrows();
    let at = problem.linearise(state);
    let moved = |i: usize, d: &Derivatives| {
        let (row, inputs) = (&problem.data.rows[i], &problem.conditions.rows[i]);
        let with = |term: &ModelTerm, times: f64| match term {
            ModelTerm::Arm(term) if term.order == tau => {
                let other = truearm::effects::Term { order: tau * times, ..*term };
                d.column(&other, inputs, &row.q, &problem.nominal) * term.coefficient
            }
            _ => Vector3::zeros(),
        };
        let late = state.terms.iter().filter(|term| term.time_constant().is_some());
        let change = late.map(|term| with(term, 1.0 + VARIED) - with(term, 1.0 - VARIED));
        vec![change.sum::<Vector3<f64>>() / (2.0 * VARIED * tau)]
    };
    let leaf = |rows: &[usize]| {
        let (mut coupled, mut own) = (DVector::zeros(unknowns), 0.0);
        for row in rows {
            let e = at.equations_beside(*row, &moved);
            let column = e.block.column(unknowns);
            coupled += e.block.columns(0, unknowns).tr_mul(&column);
            own += column.norm_squared();
        }
        (coupled, own)
    };
    let join = |a: (DVector<f64>, f64), b: (DVector<f64>, f64)| (a.0 + b.0, a.1 + b.1);
    let (coupled, own) = tree(&findings.found.robust.kept, CHUNK, &leaf, &join);
    let moved = covariance * &coupled;
    let told = own - coupled.dot(&moved);
    // What rounding leaves of a time constant that nothing tells is no information.
    (told > 1e-9 * own).then(|| (1.0 / told, -moved))
}
