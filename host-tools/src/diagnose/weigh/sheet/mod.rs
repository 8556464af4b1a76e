//! Rows linearised once, with the columns of every candidate beside those of
//! geometry: all that evidence, folds and halves need.

mod beside_springs;
mod exchange;
mod extra_unknowns;
mod held;
mod line_scan;
mod repeats;
mod residuals;
mod scattered;
mod sums;
mod tool_point;
mod turning;

use nalgebra::{DMatrix, DVector, Vector3};
use truearm::LinkParameter;
use truearm::effects::Term;

use super::curve::{self, Curve};
use super::possible::{Possible, of_arm};
use crate::diagnose::bending::Bending;
use crate::diagnose::policy::POLICY;
use crate::identify::{Linearised, Problem, Scatterer, State, Unknown};
use crate::model::arm::Derivatives;
use beside_springs::shares;
use held::held;
pub use line_scan::{Along, Way};
pub use repeats::counted;
use repeats::differs;
pub use scattered::{Moved, Scattered, seen};
pub use tool_point::ByCurves;
pub use turning::ratio as turning;

/// Precision that holds an unknown at nothing.
pub const HELD: f64 = 1e24;

/// How much each row counts, and what the readings of a pose have in common.
#[derive(Debug, Clone)]
pub struct Weights {
    /// Of each row of the file.
    pub rows: Vec<f64>,
    /// Share of the variance that is common to the readings of a pose.
    pub common: f64,
    /// Variance of a turn of the flange, rad^2, that targets of a pose share, over that of what
    /// they do not.
    pub turning: f64,
    /// What scatters by itself, and the ratio of its variance, rad^2 or m^2, to that of the
    /// stated noise.
    pub scattering: Vec<(Scatterer, f64)>,
    /// Log likelihood of the tails that the weights of rows stand for, which the evidence lacks.
    pub beyond: f64,
}

impl Weights {
    /// Of rows that count alike.
    #[must_use]
    pub fn alike(rows: usize) -> Self {
        Self {
            rows: vec![1.0; rows],
            common: 0.0,
            turning: 0.0,
            scattering: Vec::new(),
            beyond: 0.0,
        }
    }
}

/// A linearised data set.
pub struct Sheet<'a> {
    problem: &'a Problem<'a>,
    at: Linearised<'a>,
    possible: &'a [Possible],
    /// Terms of the arm that they have, in turn.
    arm_terms: Vec<Term<f64>>,
    /// Coefficient of every column in the state.
    held: DVector<f64>,
    /// Columns of candidates that may differ between readings of a pose.
    differing: Vec<usize>,
    weights: &'a Weights,
    curves: &'a [Curve],
    /// What the moments of links bend, a part of geometry.
    bending: Option<Bending>,
    /// How much of each spring's action their columns are without, where masses were only
    /// assumed; they count from where the state has them then.
    shares: Option<DMatrix<f64>>,
    /// What the state has of each, in units, from where the prior has it.
    held_moments: Vec<f64>,
    /// Curves are candidates of their own, behind the others, instead of geometry.
    apart: bool,
}

/// Coefficients of candidates and of geometry that go together.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Of every candidate's columns.
    pub columns: DVector<f64>,
    /// Of geometry, counted from nominal, in units, then of the curves, rad.
    pub geometry: DVector<f64>,
}

impl<'a> Sheet<'a> {
    /// Of `problem`, geometry only, at a state whose terms are among those of
    /// the candidates.
    #[must_use]
    pub fn new(
        problem: &'a Problem<'a>,
        state: &State,
        possible: &'a [Possible],
        weights: &'a Weights,
        curves: &'a [Curve],
    ) -> Self {
        let columns: Vec<_> = possible.iter().flat_map(Possible::coefficients_zero).collect();
        let own = |k: &usize| columns[*k].as_ref().is_some_and(differs);
        let differing = (0..columns.len()).filter(own).collect();
        Self {
            held: held(&columns, &state.terms),
            differing,
            at: problem.linearise(state),
            problem,
            arm_terms: possible.iter().flat_map(Possible::arm_terms).collect(),
            possible,
            weights,
            curves,
            bending: None,
            shares: None,
            held_moments: Vec::new(),
            apart: false,
        }
    }

    /// The same where moments of links bend springs.
    #[must_use]
    pub fn bending(self, bending: Option<Bending>, rows: &[usize], lambda: f64) -> Self {
        let Some(bending) = bending else { return self };
        let shares = bending.is_assumed().then(|| shares(&self, &bending, rows, lambda));
        let held_moments = match shares {
            Some(_) => vec![0.0; bending.found().len()],
            None => bending.found().to_vec(),
        };
        Self { shares, held_moments, bending: Some(bending), ..self }
    }

    /// The same with the columns of its curves behind those of the candidates.
    #[must_use]
    pub fn with_curves_apart(self) -> Self {
        Self { apart: true, ..self }
    }

    /// Unknowns of geometry without curves: those of the problem, then moments.
    fn unknowns(&self) -> usize {
        self.problem.unknowns.list().len() + self.held_moments.len()
    }

    /// The moments of a solution, in units; none where nothing bends.
    #[must_use]
    pub fn moments(&self, solution: &Solution) -> Vec<f64> {
        let own = self.problem.unknowns.list().len()..self.unknowns();
        let own = solution.geometry.as_slice()[own].iter();
        match (&self.shares, &self.bending) {
            (Some(_), Some(bending)) => {
                own.zip(bending.found()).map(|(more, old)| old + more).collect()
            }
            _ => own.copied().collect(),
        }
    }

    /// Diagonal of geometry's prior: tolerances of links, 10 m of a base, 1 m of
    /// a tool.
    #[must_use]
    pub fn precision(&self, lambda: f64) -> DVector<f64> {
        let unknowns = &self.problem.unknowns;
        let of = |(k, unknown): (usize, &Unknown)| {
            let unit = self.problem.unit(*unknown);
            match unknown {
                Unknown::Link(_, LinkParameter::Theta)
                    if self.problem.stated(*unknown).is_none() =>
                {
                    lambda / POLICY.zero_prior.powi(2)
                }
                _ if k >= unknowns.free() => lambda,
                Unknown::Marker(..) => (unit / POLICY.tool_prior).powi(2),
                _ => (unit / POLICY.base_prior).powi(2),
            }
        };
        let rigid = unknowns.list().iter().enumerate().map(of);
        let moments = self.held_moments.iter().map(|_| 1.0);
        let curves = self.curves.iter().filter(|_| !self.apart);
        let curves = curves.flat_map(|c| c.prior.variances()).map(|v| 1.0 / v);
        let all: Vec<f64> = rigid.chain(moments).chain(curves).collect();
        DVector::from_vec(all)
    }

    /// The same prior, the moments held where they are stated.
    #[must_use]
    pub fn holding_moments(&self, precision: &DVector<f64>) -> DVector<f64> {
        let mut held = precision.clone();
        let own = self.problem.unknowns.list().len()..self.unknowns();
        held.rows_mut(own.start, own.len()).fill(HELD);
        held
    }

    /// Unknowns of geometry, curves among them, and columns of candidates.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        let curves = curve::columns(self.curves);
        match self.apart {
            true => [self.unknowns(), self.held.len() + curves],
            false => [self.unknowns() + curves, self.held.len()],
        }
    }

    /// Columns of the candidates; what the row says is looked up once for all of them.
    fn beside(&self, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let mut of_arm = of_arm(self.problem, &self.arm_terms, index, d);
        let of = |possible: &Possible| possible.columns_by(self.problem, index, d, &mut of_arm);
        let columns = self.possible.iter().flat_map(of).collect();
        debug_assert!(of_arm.next().is_none(), "a term has one column");
        columns
    }
}
