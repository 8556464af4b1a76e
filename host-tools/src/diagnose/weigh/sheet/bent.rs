//! Curves of joints and moments of links: unknowns of geometry beside those of the
//! problem.

use nalgebra::{DVector, Vector3};

use super::{Sheet, Solution};
use crate::diagnose::weigh::curves::{self, Curve};
use crate::evidence;
use crate::identify::Equations;
use crate::model::ErrorCurve;
use crate::model::arm::Derivatives;

impl Sheet<'_> {
    /// What a curve does in the state, rad.
    pub(super) fn bent(&self, index: usize, curve: &Curve) -> f64 {
        let curves = &self.problem.conditions.rows[index].curves;
        curves.get(curve.joint).copied().unwrap_or(0.0)
    }

    /// What the moments of the state do in a row's equations.
    pub(super) fn of_moments(&self, e: &Equations) -> DVector<f64> {
        let held = DVector::from_column_slice(self.held_moments());
        e.block.columns(self.unknowns() - held.len(), held.len()) * held
    }

    /// Columns of moments, then of the joints that have a curve.
    pub(super) fn of_geometry(&self, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let of = |c: &Curve| *d.links[c.joint].joint(self.problem.nominal[c.joint].kind);
        let bending = self.bending.as_ref();
        let mut all = bending.map_or(Vec::new(), |b| b.columns(self.problem, index, d));
        all.extend(self.curves.iter().map(of));
        all
    }

    /// Where the columns of a curve stand in geometry.
    #[must_use]
    pub fn columns_of_curve(&self, k: usize) -> std::ops::Range<usize> {
        let first = self.unknowns() + curves::columns(&self.curves[..k]);
        first..first + 2 * self.curves[k].orders()
    }

    /// The functions of a solution as tables.
    #[must_use]
    pub fn tables(&self, solution: &Solution, geometry: &evidence::Geometry) -> Vec<ErrorCurve> {
        let mut first = self.unknowns();
        let mut out = Vec::new();
        for curve in self.curves {
            let count = 2 * curve.orders();
            let own = solution.geometry.rows(first, count).into_owned();
            let rows = self.problem.data.rows.iter().map(|row| row.q[curve.joint]);
            let band = curves::band(curve, rows, geometry, first);
            out.extend(curve.table(own.as_slice(), band));
            first += count;
        }
        out
    }
}
