//! What estimates scatter where a part of the noise is along the way that some joint moves:
//! the fit takes it for the same every way, its estimate scatters as the noise is (White,
//! Econometrica 48 (1980) 817).

use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;

use crate::identify::Linearised;
use crate::identify::problem::Problem;
use crate::model::arm::Derivatives;
use crate::observations::postures;

/// How the target of a row moves with joints wherever the arm stood for it, joint by joint.
#[must_use]
pub fn ways(
    problem: &Problem,
    joints: impl Iterator<Item = usize>,
    index: usize,
    (i, d): (usize, &Derivatives),
) -> Vec<Vector3<f64>> {
    let ends = postures(&problem.data.rows, &[index]);
    let of_joint = |joint: usize| {
        let turned = *d.links[joint].joint(problem.nominal[joint].kind);
        ends.iter().map(move |end| if *end == i { turned } else { Vector3::zeros() })
    };
    joints.flat_map(of_joint).collect()
}

/// `A'VA` of rows whose stated noise is so distributed, V a row's covariance in units of it.
#[must_use]
pub fn information(problem: &Problem, at: &Linearised, rows: &[usize]) -> DMatrix<f64> {
    let unknowns = problem.unknowns.list().len();
    let joints = || problem.scattering.iter().map(|joint| joint.0);
    let of_row = |row: &usize| {
        let e = at.equations_beside(*row, &|i, d| ways(problem, joints(), *row, (i, d)));
        let mut ways = e.block.columns(unknowns, e.block.ncols() - unknowns).into_owned();
        let ends = ways.ncols() / problem.scattering.len();
        for (k, mut way) in ways.column_iter_mut().enumerate() {
            way *= problem.scattering[k / ends].1;
        }
        let block = e.block.columns(0, unknowns).into_owned();
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
