//! What a scan for lines and steps needs.

use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

use super::{Sheet, counted};
use crate::evidence;
use crate::evidence::lines::JointColumn;
use crate::model::Values;
use crate::model::arm::Derivatives;
use crate::observations::postures;

/// How the target of a row moves along each of some ways.
pub type Ways<'w> = dyn Fn(usize, &Derivatives) -> Vec<Vector3<f64>> + Sync + 'w;

impl Sheet<'_> {
    /// How the target moves along each of `count` ways wherever the arm stood, in the order
    /// of [`postures`], and along it what the most probable geometry, `mean`, leaves (rows may
    /// have other weights than in the last fit, and what geometry imitates must be nothing
    /// by these); without joint values. All ways in one
    /// pass of the rows, whose equations cost more than the ways. What both ends of a pair
    /// have in common is left to the evidence: of many it is nothing on the average. Readings
    /// of a pose count as in the Gram matrix that `geometry` is of.
    #[must_use]
    pub fn along(
        &self,
        rows: &[usize],
        (count, ways): (usize, &Ways),
        (geometry, mean): (&evidence::Geometry, &DVector<f64>),
        scale: f64,
    ) -> Vec<JointColumn> {
        let p = self.problem.unknowns.list().len();
        let data = &self.problem.data.rows;
        let counts = counted(self.problem, rows, self.weights.common);
        let one = |(index, counts): (&usize, &f64)| {
            let ends = postures(data, &[*index]);
            let own = |i: usize, d: &Derivatives, end: usize| match i == end {
                true => ways(i, d),
                false => vec![Vector3::zeros(); count],
            };
            let beside = |i: usize, d: &Derivatives| {
                let ways = ends.iter().flat_map(|e| own(i, d, *e));
                ways.chain(self.scattered(*index, i, d)).collect()
            };
            let e = self.at.equations_beside(*index, &beside);
            let explained = e.block.columns(0, p) * mean;
            let residual = Values::from_fn(e.rhs.len(), |c| e.rhs[c] - explained[c]);
            let (block, residual) = self.beside_scatter(e.block, residual, ends.len());
            let weight = (self.weights.rows[*index] * counts).sqrt();
            let moved = block.columns(p, ends.len() * count) * (weight / scale);
            let right = moved.tr_mul(&residual.column()) * (weight / scale);
            let products = block.columns(0, p).tr_mul(&moved) * (weight * scale);
            let of_end = |end: usize| {
                let range = end * count..(end + 1) * count;
                let squares = range.clone().map(|k| moved.column(k).norm_squared()).collect();
                let products = products.columns(range.start, count).into_owned();
                Posture { squares, rights: right.as_slice()[range].to_vec(), products }
            };
            (0..ends.len()).map(of_end).collect::<Vec<_>>()
        };
        let all: Vec<Posture> = rows.par_iter().zip(&counts).flat_map_iter(one).collect();
        let of_way = |way: usize| {
            let mut imitated = DMatrix::zeros(p, all.len());
            for (k, posture) in all.iter().enumerate() {
                imitated.set_column(k, &posture.products.column(way));
            }
            JointColumn {
                q: Vec::new(),
                square: all.iter().map(|a| a.squares[way]).collect(),
                right: all.iter().map(|a| a.rights[way]).collect(),
                imitated: geometry.whiten(&imitated),
            }
        };
        (0..count).into_par_iter().map(of_way).collect()
    }
}

/// Where the arm stood once: an entry or a column for each way.
struct Posture {
    squares: Vec<f64>,
    rights: Vec<f64>,
    products: DMatrix<f64>,
}
