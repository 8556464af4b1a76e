//! How what scatters beside the noise that rows state moves them.

use nalgebra::{DMatrix, Vector3};

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
        Scatterer::Range(from) => range(problem, index, *from),
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

/// How the distance from a place moves the equations of a row; no column where no point was read.
/// Turns of a target are not asked.
fn range(problem: &Problem, index: usize, from: Place) -> DMatrix<f64> {
    let row = &problem.data.rows[index];
    let scale = problem.scale(index);
    let Some(point) = kind(row).point(row) else { return DMatrix::zeros(scale.len(), 0) };
    let line = point - from.point();
    let way = |component: usize, _| line.get(component).map_or(0.0, |x| x / scale[component]);
    DMatrix::from_fn(scale.len(), 1, way)
}
