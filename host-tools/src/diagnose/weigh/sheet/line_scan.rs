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
        // A part of the rows after the other: each way of each row takes p numbers, and all of
        // them are held once, not twice.
        let postures = postures(data, rows).len();
        let mut all: Vec<JointColumn> = (0..count).map(|_| none(p, postures)).collect();
        let mut first = 0;
        for (rows, counts) in rows.chunks(AT_ONCE).zip(counts.chunks(AT_ONCE)) {
            let part: Vec<Posture> = rows.par_iter().zip(counts).flat_map_iter(one).collect();
            all.par_iter_mut().enumerate().for_each(|(way, column)| {
                column.square.extend(part.iter().map(|a| a.squares[way]));
                column.right.extend(part.iter().map(|a| a.rights[way]));
                for (k, posture) in part.iter().enumerate() {
                    column.imitated.set_column(first + k, &posture.products.column(way));
                }
            });
            first += part.len();
        }
        all.par_iter_mut().for_each(|way| way.imitated = geometry.whiten(&way.imitated));
        all
    }
}

/// Rows that are looked at together.
const AT_ONCE: usize = 4096;

/// A way of which nothing is known yet.
fn none(unknowns: usize, postures: usize) -> JointColumn {
    JointColumn {
        q: Vec::new(),
        square: Vec::with_capacity(postures),
        right: Vec::with_capacity(postures),
        imitated: DMatrix::zeros(unknowns, postures),
    }
}

/// Where the arm stood once: an entry or a column for each way.
struct Posture {
    squares: Vec<f64>,
    rights: Vec<f64>,
    products: DMatrix<f64>,
}
