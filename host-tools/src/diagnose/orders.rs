//! Orders of lines, which are found as sizes and phases are. Over a narrow range of its joint a
//! line of 80 cycles a turn and one of 82 look alike.

use nalgebra::{DMatrix, Vector3};
use truearm::effects::{Effect, Term};

use super::beside::{Beside, Fitted};
use crate::model::ModelTerm;
use crate::model::arm::Derivatives;

/// By so much an order is varied for a derivative, cycles a turn: a phase of a hundredth over a
/// whole turn either way.
const VARIED: f64 = 1.0 / 1024.0;

/// A line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Its joint, counted from 0.
    joint: u8,
    order: f64,
    /// One standard deviation of the order beside all unknowns, cycles a turn; infinite where
    /// nothing tells it.
    pub sigma: f64,
}

impl Line {
    fn of(term: &ModelTerm) -> Option<Self> {
        match term {
            // Orders that are the teeth of a gear, or one a turn, are known.
            ModelTerm::Arm(t) if t.effect == Effect::JointPeriodicError => {
                Some(Self { joint: t.own_joint()?, order: t.order, sigma: f64::INFINITY })
            }
            _ => None,
        }
    }

    /// Whether a term is of this line.
    #[must_use]
    pub fn has(&self, term: &ModelTerm) -> bool {
        Self::of(term).is_some_and(|own| (own.joint, own.order) == (self.joint, self.order))
    }
}

/// The lines of a model at a fit of which the covariance of all unknowns is known, in units, and
/// how sure their orders are.
#[must_use]
pub fn lines(at: &Fitted, covariance: &DMatrix<f64>) -> Vec<Line> {
    let terms = &at.state.terms;
    let mut found: Vec<Line> = Vec::new();
    for line in terms.iter().filter_map(Line::of) {
        if !found.contains(&line) {
            found.push(line);
        }
    }
    if found.is_empty() {
        return found;
    }
    let own = |line: &Line| -> Vec<Term<f64>> {
        let arm = |term: &ModelTerm| match term {
            ModelTerm::Arm(own) => Some(*own),
            _ => None,
        };
        terms.iter().filter(|t| line.has(t)).filter_map(arm).collect()
    };
    let terms: Vec<_> = found.iter().map(own).collect();
    let problem = at.problem;
    let columns = |i: usize, d: &Derivatives| -> Vec<Vector3<f64>> {
        let (q, inputs) = (&problem.data.rows[i].q, &problem.conditions.rows[i]);
        let slope = |term: &Term<f64>| {
            let with = |order: f64| d.column(&Term { order, ..*term }, inputs, q, &problem.nominal);
            let apart = with(term.order + VARIED) - with(term.order - VARIED);
            apart * (term.coefficient / (2.0 * VARIED))
        };
        terms.iter().map(|own| own.iter().map(slope).sum()).collect()
    };
    let Beside { coupled, own } = at.beside(&columns, (covariance.nrows(), found.len()));
    // What rows tell of the orders when every unknown is free, by Schur's complement.
    let told = own - coupled.tr_mul(&(covariance * &coupled));
    if let Some(variances) = told.cholesky().map(|told| told.inverse()) {
        for (k, line) in found.iter_mut().enumerate() {
            line.sigma = variances[(k, k)].sqrt();
        }
    }
    found
}
