//! Joints that scatter by themselves: the noise of a row is larger the way they move its target.

use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

use super::Sheet;
use crate::evidence::directed::whiten;
use crate::identify::certainty::directed::ways;
use crate::identify::{Linearised, Problem, State};
use crate::model::Values;
use crate::model::arm::Derivatives;

/// How a joint moves the target of a row, in stated sigmas a rad, a column for each place
/// where the arm stood for it, and the row's residual: both without what others scatter.
#[must_use]
pub fn along(
    at: &Linearised,
    problem: &Problem,
    index: usize,
    joint: usize,
    others: &[(usize, f64)],
) -> (DMatrix<f64>, Values) {
    let joints = || std::iter::once(joint).chain(others.iter().map(|other| other.0));
    let e = at.equations_beside(index, &|i, d| ways(problem, joints(), index, (i, d)));
    let residual = e.scaled_residual();
    let unknowns = problem.unknowns.list().len();
    let block = e.block.columns(unknowns, e.block.ncols() - unknowns).into_owned();
    let ends = block.ncols() / (1 + others.len());
    apart(block, residual, &ratios(others, ends))
}

/// The ratio of every column.
fn ratios(scattering: &[(usize, f64)], ends: usize) -> Vec<f64> {
    scattering.iter().flat_map(|(_, ratio)| std::iter::repeat_n(*ratio, ends)).collect()
}

impl Sheet<'_> {
    /// Columns of the joints that scatter, behind all others of a row.
    pub(super) fn scattered(&self, index: usize, i: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let joints = self.weights.scattering.iter().map(|scattering| scattering.0);
        ways(self.problem, joints, index, (i, d))
    }

    /// A row's equations and its residual without those columns, multiplied by the root of
    /// the inverse covariance that they make.
    pub(super) fn beside_scatter(
        &self,
        block: DMatrix<f64>,
        residual: Values,
        ends: usize,
    ) -> (DMatrix<f64>, Values) {
        apart(block, residual, &ratios(&self.weights.scattering, ends))
    }
}

/// Equations whose last columns are directions of these ratios of variance, and a residual:
/// both without them, the noise the same every way.
fn apart(block: DMatrix<f64>, residual: Values, ratios: &[f64]) -> (DMatrix<f64>, Values) {
    if ratios.is_empty() {
        return (block, residual);
    }
    let (own, all) = (block.ncols() - ratios.len(), block.ncols());
    let mut wide = block.insert_column(all, 0.0);
    residual.iter().enumerate().for_each(|(i, r)| wide[(i, all)] = *r);
    for (k, ratio) in ratios.iter().enumerate() {
        let way: DVector<f64> = wide.column(own + k).into_owned();
        whiten(&mut wide, &way, *ratio);
    }
    let residual = Values::from_fn(wide.nrows(), |i| wide[(i, all)]);
    (wide.remove_columns(own, ratios.len() + 1), residual)
}

/// What joints that scatter make of the noise of rows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Scattered {
    /// `log |V|`.
    pub log_det: f64,
    /// Variance by them over the other variance, summed over the equations...
    more: f64,
    /// ...which are so many.
    equations: usize,
}

impl Scattered {
    /// Of rows whose joints scatter so.
    #[must_use]
    pub fn of(problem: &Problem, state: &State, rows: &[usize], joints: &[(usize, f64)]) -> Self {
        let at = problem.linearise(state);
        let of_joint = |row: usize, k: usize| {
            let (joint, ratio) = joints[k];
            let (ways, _) = along(&at, problem, row, joint, &[]);
            let (beside, _) = along(&at, problem, row, joint, &joints[..k]);
            let of_way = |way: usize| (1.0 + ratio * beside.column(way).norm_squared()).ln();
            let log_det = (0..beside.ncols()).map(of_way).sum();
            Self { log_det, more: ratio * ways.norm_squared(), equations: ways.nrows() }
        };
        let of_row = |row: &usize| {
            let all = (0..joints.len()).map(|k| of_joint(*row, k));
            all.fold(Self::default(), |sum, own| Self { equations: own.equations, ..sum.plus(own) })
        };
        let each: Vec<Self> = rows.par_iter().map(of_row).collect();
        each.into_iter().fold(Self::default(), Self::plus)
    }

    fn plus(self, other: Self) -> Self {
        Self {
            log_det: self.log_det + other.log_det,
            more: self.more + other.more,
            equations: self.equations + other.equations,
        }
    }

    /// How many times the other noise all of it is together, as a root mean square over the
    /// equations.
    #[must_use]
    pub fn together(&self) -> f64 {
        (1.0 + self.more / self.equations.max(1) as f64).sqrt()
    }
}
