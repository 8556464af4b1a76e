//! Curves of joints and moments of links: unknowns of geometry beside those of the
//! problem.

use nalgebra::{DVector, Vector3};

use super::{Sheet, Solution};
use crate::diagnose::weigh::curve::{self, Curve};
use crate::evidence;
use crate::identify::Equations;
use crate::model::arm::Derivatives;
use crate::model::{ErrorCurve, Row};

impl Sheet<'_> {
    /// What the curves of the state do where the arm stands at a row.
    pub(crate) fn bent(&self, index: usize, d: &Derivatives) -> Vector3<f64> {
        let here = &self.problem.conditions.rows[index].curves;
        let value = |c: &Curve| here.get(c.joint).copied().unwrap_or(0.0);
        self.curves.iter().map(|c| self.of_joint(c, d) * value(c)).sum()
    }

    fn of_joint(&self, curve: &Curve, d: &Derivatives) -> Vector3<f64> {
        *d.links[curve.joint].joint(self.problem.nominal[curve.joint].kind)
    }

    /// What the moments of the state do in a row's equations.
    pub(crate) fn by_moments(&self, e: &Equations) -> DVector<f64> {
        let held = DVector::from_column_slice(&self.held_moments);
        e.block.columns(self.unknowns() - held.len(), held.len()) * held
    }

    /// Columns of moments.
    pub(crate) fn of_moments(&self, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let Some(bending) = &self.bending else { return Vec::new() };
        let mut columns = bending.columns(self.problem, index, d);
        let Some(shares) = &self.shares else { return columns };
        let actions = bending.actions(self.problem, index, d);
        for (column, of) in columns.iter_mut().zip(shares.column_iter()) {
            actions.iter().zip(of.iter()).for_each(|(action, share)| *column -= action * *share);
        }
        columns
    }

    /// Columns of the curves' coefficients.
    pub(crate) fn of_curves(&self, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let q = &self.problem.data.rows[index].q;
        let of = |c: &Curve| {
            let joint = self.of_joint(c, d);
            c.basis(q[c.joint]).into_iter().map(move |value| joint * value)
        };
        self.curves.iter().flat_map(of).collect()
    }

    /// What the curves of each solution do where the arm stands at a row.
    pub(crate) fn by_curves(
        &self,
        index: usize,
        d: &Derivatives,
        of: &[Solution],
    ) -> Vec<Vector3<f64>> {
        let q = &self.problem.data.rows[index].q;
        let mut sums = vec![Vector3::zeros(); of.len()];
        let mut first = self.unknowns();
        for curve in self.curves {
            let joint = self.of_joint(curve, d);
            let basis = curve.basis(q[curve.joint]);
            for (sum, solution) in sums.iter_mut().zip(of) {
                let own = solution.geometry.rows(first, basis.len());
                *sum += joint * basis.iter().zip(own.iter()).map(|(b, c)| b * c).sum::<f64>();
            }
            first += basis.len();
        }
        sums
    }

    /// Where the columns of a curve stand in geometry.
    #[must_use]
    pub fn columns_of_curve(&self, k: usize) -> std::ops::Range<usize> {
        let first = self.unknowns() + curve::columns(&self.curves[..k]);
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
            // Readings of a pose tell its angle once.
            let mut poses: Vec<&Row> = self.problem.data.rows.iter().collect();
            poses.sort_by_key(|row| row.pose);
            poses.dedup_by_key(|row| row.pose);
            let angles: Vec<f64> = poses.iter().map(|row| row.q[curve.joint]).collect();
            let band = curve::band(curve, &angles, geometry, first);
            let gaps = curve::gaps(curve, &angles, geometry, first);
            out.extend(curve.table(own.as_slice(), band, &gaps));
            first += count;
        }
        out
    }
}
