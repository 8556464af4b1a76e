//! What a scan for lines needs of a joint.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::Sheet;
use crate::evidence;
use crate::model::arm::Derivatives;

impl Sheet<'_> {
    /// A joint's column at the rows, and the residual along it, for a scan.
    #[must_use]
    pub fn joint(
        &self,
        rows: &[usize],
        joint: usize,
        geometry: &evidence::Geometry,
        scale: f64,
    ) -> evidence::lines::JointColumn {
        let p = self.problem.unknowns.list().len();
        let kind = self.problem.nominal[joint].kind;
        let one = |index: &usize| {
            let beside = |_: usize, d: &Derivatives| vec![*d.links[joint].joint(kind)];
            let e = self.at.equations_beside(*index, &beside);
            let weight = self.weights.rows[*index];
            let column = e.block.column(p) * (weight.sqrt() / scale);
            let residual = e.scaled_residual();
            let right: f64 = column.iter().zip(residual.iter()).map(|(c, r)| c * r).sum();
            let products = e.block.columns(0, p).tr_mul(&column) * (weight.sqrt() * scale);
            (column.norm_squared(), right * weight.sqrt() / scale, products)
        };
        let all: Vec<_> = rows.par_iter().map(one).collect();
        let mut imitated = DMatrix::zeros(p, rows.len());
        for (k, (_, _, products)) in all.iter().enumerate() {
            imitated.set_column(k, products);
        }
        evidence::lines::JointColumn {
            q: rows.iter().map(|r| self.problem.data.rows[*r].q[joint]).collect(),
            square: all.iter().map(|a| a.0).collect(),
            right: all.iter().map(|a| a.1).collect(),
            imitated: geometry.whiten(&imitated),
        }
    }
}
