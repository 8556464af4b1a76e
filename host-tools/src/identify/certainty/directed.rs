//! What scatters beside the noise that rows state, and what estimates scatter for it: the fit
//! takes its noise for the same every way, its estimate scatters as the noise is (White,
//! Econometrica 48 (1980) 817).

use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;

use crate::identify::Linearised;
use crate::identify::problem::{Place, Problem, Scatterer};
use crate::model::arm::Derivatives;
use crate::observations::{kind, postures};

/// How the target of a row moves with the joints among these wherever the arm stood for it, joint
/// by joint.
#[must_use]
pub fn ways(
    problem: &Problem,
    sources: impl Iterator<Item = Scatterer>,
    index: usize,
    (i, d): (usize, &Derivatives),
) -> Vec<Vector3<f64>> {
    let ends = postures(&problem.data.rows, &[index]);
    let of_joint = |joint: usize| {
        let turned = *d.links[joint].joint(problem.nominal[joint].kind);
        ends.iter().map(move |end| if *end == i { turned } else { Vector3::zeros() })
    };
    sources.filter_map(Scatterer::joint).flat_map(of_joint).collect()
}

/// How equations of a row move with each of these, in stated sigmas a rad or m. The last columns
/// of `block` are those of [`ways`]; what stands before them comes first.
#[must_use]
pub fn columns(
    problem: &Problem,
    sources: impl Iterator<Item = Scatterer>,
    index: usize,
    block: &DMatrix<f64>,
) -> (DMatrix<f64>, Vec<DMatrix<f64>>) {
    let sources: Vec<Scatterer> = sources.collect();
    let ends = postures(&problem.data.rows, &[index]).len();
    let joints = sources.iter().filter(|source| source.joint().is_some()).count();
    let own = block.ncols() - joints * ends;
    let mut at = own;
    let of = |source: &Scatterer| match source {
        Scatterer::Joint(_) => {
            at += ends;
            block.columns(at - ends, ends).into_owned()
        }
        Scatterer::Sight(from) => sight(problem, index, *from),
    };
    let all = sources.iter().map(of).collect();
    (block.columns(0, own).into_owned(), all)
}

/// How turns of the line of sight from a place about each axis move the equations of a row; no columns where
/// no point was read. How a target is turned is read the worse, too, by as much in the mean: that
/// poses are noisier in points than along their sights is no scatter of their turns.
fn sight(problem: &Problem, index: usize, from: Place) -> DMatrix<f64> {
    let row = &problem.data.rows[index];
    let scale = problem.scale(index);
    let Some(point) = kind(row).point(row) else { return DMatrix::zeros(scale.len(), 0) };
    let point = point - from.point();
    let moved = point.cross_matrix();
    let turned = (2.0_f64 / 3.0).sqrt() * point.norm() / scale[0];
    let way = |component: usize, axis: usize| match (component < 3, axis < 3) {
        (true, true) => moved[(component, axis)] / scale[component],
        (false, false) if component == axis => turned,
        _ => 0.0,
    };
    DMatrix::from_fn(scale.len(), scale.len(), way)
}

/// `A'VA` of rows whose stated noise is so distributed, V a row's covariance in units of it.
#[must_use]
pub fn information(problem: &Problem, at: &Linearised, rows: &[usize]) -> DMatrix<f64> {
    let unknowns = problem.unknowns.list().len();
    let sources = || problem.scattering.iter().map(|source| source.0);
    let of_row = |row: &usize| {
        let e = at.equations_beside(*row, &|i, d| ways(problem, sources(), *row, (i, d)));
        let (block, each) = columns(problem, sources(), *row, &e.block);
        let mut ways = DMatrix::zeros(block.nrows(), 0);
        for (own, (_, size)) in each.iter().zip(&problem.scattering) {
            let first = ways.ncols();
            ways = ways.insert_columns(first, own.ncols(), 0.0);
            ways.columns_mut(first, own.ncols()).copy_from(&(own * *size));
        }
        let along = block.tr_mul(&ways);
        (block.tr_mul(&block), &along * along.transpose(), ways.norm_squared(), ways.nrows())
    };
    let mut plain = DMatrix::zeros(unknowns, unknowns);
    let mut along = plain.clone();
    let (mut square, mut equations) = (0.0, 0);
    for chunk in rows.chunks(CHUNK) {
        let each: Vec<_> = chunk.par_iter().map(of_row).collect();
        for row in each {
            plain += row.0;
            along += row.1;
            square += row.2;
            equations += row.3;
        }
    }
    // What is along the joints is a part of the stated noise, not beside it.
    let rest = (1.0 - square / equations.max(1) as f64).max(0.0);
    plain * rest + along
}

/// Rows at a time, so that what is held does not grow with them.
const CHUNK: usize = 128;
