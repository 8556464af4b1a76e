//! Moments of links that nobody weighed, apart from the springs that they bend.
//!
//! What a spring does is a product, of its coefficient and the moments. With moments that are
//! quite free a model without the spring would have all of it nevertheless, and no spring were
//! ever needed. So the moments have what no spring does alone: of each of their columns the
//! part that is like a spring's, geometry projected off, is taken away, for the spring's
//! coefficient to have.

use nalgebra::DMatrix;

use super::Sheet;
use super::sums::PART;
use crate::diagnose::bending::Bending;
use crate::identify::problem::accumulate::tree;
use crate::model::arm::Derivatives;

/// Springs of actions that are alike but for this are one.
const ALIKE: f64 = 1e-9;

/// How much of each spring's action (a row) is in each moment's column, and is taken away.
pub fn shares(sheet: &Sheet, bending: &Bending, rows: &[usize], lambda: f64) -> DMatrix<f64> {
    let rigid = sheet.problem.unknowns.list().len();
    let moments = bending.found().len();
    let beside = |i: usize, d: &Derivatives| {
        [bending.columns(sheet.problem, i, d), bending.actions(sheet.problem, i, d)].concat()
    };
    let leaf = |own: &[usize]| {
        let of = |row: &usize| {
            let block = sheet.at.equations_beside(*row, &beside).block;
            block.tr_mul(&block) * sheet.weights.rows[*row]
        };
        own.iter().map(of).reduce(|a, b| a + b).unwrap_or_default()
    };
    let sums = tree(rows, PART, &leaf, &|a: DMatrix<f64>, b| a + b);
    let springs = sums.nrows().saturating_sub(rigid + moments);
    let none = DMatrix::zeros(springs, moments);
    if springs == 0 {
        return none;
    }
    let geometry = sums.view((0, 0), (rigid, rigid)).into_owned()
        + DMatrix::from_diagonal(&sheet.precision(lambda).rows(0, rigid).into_owned());
    let Some(factor) = geometry.cholesky() else { return none };
    let of_springs = sums.view((0, rigid + moments), (rigid, springs)).into_owned();
    let absorbed = sums.view((rigid, 0), (moments + springs, rigid)) * factor.solve(&of_springs);
    let left = sums.view((rigid, rigid + moments), (moments + springs, springs)) - absorbed;
    // In units of each spring's own action: they differ by powers of ten.
    let own = left.rows(moments, springs).into_owned();
    let size = own.diagonal().map(|square| square.max(f64::MIN_POSITIVE).sqrt());
    let alike = DMatrix::from_fn(springs, springs, |i, j| own[(i, j)] / (size[i] * size[j]));
    let with = DMatrix::from_fn(springs, moments, |s, k| left[(k, s)] / size[s]);
    let Ok(inverse) = alike.pseudo_inverse(ALIKE) else { return none };
    let mut shares = inverse * with;
    shares.row_iter_mut().zip(size.iter()).for_each(|(mut row, size)| row /= *size);
    shares
}
