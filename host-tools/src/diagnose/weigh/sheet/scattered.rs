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

/// How many times the other noise all of it is together with what joints scatter, as a root
/// mean square over the equations of rows.
#[must_use]
pub fn together(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    scattering: &[(usize, f64)],
) -> f64 {
    let at = problem.linearise(state);
    let of_row = |row: &usize| {
        let of_joint = |(joint, ratio): &(usize, f64)| {
            let (ways, _) = along(&at, problem, *row, *joint, &[]);
            [ratio * ways.norm_squared(), ways.nrows() as f64]
        };
        scattering.iter().map(of_joint).fold([0.0; 2], |a, b| [a[0] + b[0], b[1]])
    };
    let each: Vec<[f64; 2]> = rows.par_iter().map(of_row).collect();
    let [more, equations] = each.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    if equations > 0.0 { (1.0 + more / equations).sqrt() } else { 1.0 }
}

/// `log |V|` of rows whose joints scatter so.
#[must_use]
pub fn log_det(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    scattering: &[(usize, f64)],
) -> f64 {
    let at = problem.linearise(state);
    let of_row = |row: &usize| {
        let of_joint = |k: usize| {
            let (joint, ratio) = scattering[k];
            let (ways, _) = along(&at, problem, *row, joint, &scattering[..k]);
            let of_way = |way: usize| (1.0 + ratio * ways.column(way).norm_squared()).ln();
            (0..ways.ncols()).map(of_way).sum::<f64>()
        };
        (0..scattering.len()).map(of_joint).sum::<f64>()
    };
    rows.par_iter().map(of_row).collect::<Vec<f64>>().iter().sum()
}
