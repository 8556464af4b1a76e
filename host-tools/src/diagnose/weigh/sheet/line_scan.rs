//! What a scan for lines needs of a joint.

use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;

use super::Sheet;
use crate::evidence;
use crate::model::arm::Derivatives;
use crate::observations::postures;

impl Sheet<'_> {
    /// A joint's column wherever the arm stood for these rows, for a scan.
    #[must_use]
    pub fn joint(
        &self,
        rows: &[usize],
        joint: usize,
        geometry: &evidence::Geometry,
        scale: f64,
    ) -> evidence::lines::JointColumn {
        let kind = self.problem.nominal[joint].kind;
        let data = &self.problem.data.rows;
        let q = postures(data, rows).iter().map(|r| data[*r].q[joint]).collect();
        let column = self.along(rows, &|d| *d.links[joint].joint(kind), geometry, scale);
        evidence::lines::JointColumn { q, ..column }
    }

    /// How the target moves along a way wherever the arm stood, in the order of
    /// [`postures`], and the residual along it. What both ends of a pair have in common is
    /// left to the evidence: of many it is nothing on the average.
    #[must_use]
    pub fn along(
        &self,
        rows: &[usize],
        way: &(dyn Fn(&Derivatives) -> Vector3<f64> + Sync),
        geometry: &evidence::Geometry,
        scale: f64,
    ) -> evidence::lines::JointColumn {
        let p = self.problem.unknowns.list().len();
        let data = &self.problem.data.rows;
        let one = |index: &usize| {
            let ends = postures(data, &[*index]);
            let own = |i: usize, d: &Derivatives, end: usize| match i == end {
                true => way(d),
                false => Vector3::zeros(),
            };
            let beside = |i: usize, d: &Derivatives| ends.iter().map(|e| own(i, d, *e)).collect();
            let e = self.at.equations_beside(*index, &beside);
            let weight = self.weights.rows[*index];
            let residual = e.scaled_residual();
            let of_end = |end: usize| {
                let column = e.block.column(p + end) * (weight.sqrt() / scale);
                let right: f64 = column.iter().zip(residual.iter()).map(|(c, r)| c * r).sum();
                let products = e.block.columns(0, p).tr_mul(&column) * (weight.sqrt() * scale);
                (column.norm_squared(), right * weight.sqrt() / scale, products)
            };
            (0..ends.len()).map(of_end).collect::<Vec<_>>()
        };
        let all: Vec<_> = rows.par_iter().flat_map_iter(one).collect();
        let mut imitated = DMatrix::zeros(p, all.len());
        for (k, (_, _, products)) in all.iter().enumerate() {
            imitated.set_column(k, products);
        }
        evidence::lines::JointColumn {
            q: Vec::new(),
            square: all.iter().map(|a| a.0).collect(),
            right: all.iter().map(|a| a.1).collect(),
            imitated: geometry.whiten(&imitated),
        }
    }
}
