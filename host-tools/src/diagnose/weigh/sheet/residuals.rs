//! What a solution leaves of rows, to first order.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::sums::TOGETHER;
use super::{Sheet, Solution, counted};
use crate::model::Values;
use crate::model::arm::Derivatives;
use crate::observations::Residual;

impl Sheet<'_> {
    /// Measured minus predicted of rows, SI.
    #[must_use]
    pub fn left(&self, rows: &[usize], solution: &Solution) -> Vec<(usize, Residual)> {
        let solution = std::slice::from_ref(solution);
        let used = self.used(solution);
        let of = |index: &usize| {
            let left = self.left_of(*index, solution, &used);
            left.into_iter().map(|left| (*index, left)).collect::<Vec<_>>()
        };
        rows.par_iter().flat_map_iter(of).collect()
    }

    /// Sum of squares of the same in standard deviations, each kind's by its own noise, by
    /// each of some solutions: a row is linearised once for all of them.
    #[must_use]
    pub fn misfits(&self, rows: &[usize], solutions: &[Solution]) -> Vec<f64> {
        if solutions.is_empty() {
            return Vec::new();
        }
        let used = self.used(solutions);
        let of = |rows: &[usize]| {
            let mut sums = vec![0.0; solutions.len()];
            for row in rows {
                let scale = self.problem.scale(*row);
                for (sum, left) in sums.iter_mut().zip(self.left_of(*row, solutions, &used)) {
                    *sum += left.values().zip_map(&scale, |r, scale| r / scale).norm_squared();
                }
            }
            sums
        };
        let parts: Vec<Vec<f64>> = rows.par_chunks(TOGETHER).map(of).collect();
        (0..solutions.len()).map(|k| parts.iter().map(|sums| sums[k]).sum()).collect()
    }

    /// Sum of squares of what is left of these rows, by the noise that the evidence has: tails
    /// count for little, readings of a pose as little more than one, and what is
    /// scattered along its direction.
    #[must_use]
    pub fn weighed(&self, rows: &[usize], left: &[Option<Residual>]) -> f64 {
        let p = self.problem.unknowns.list().len();
        let counts = counted(self.problem, rows, self.weights.common);
        let one = |(index, count): (&usize, &f64)| {
            let Some(left) = left[*index].as_ref() else { return 0.0 };
            let e = self.at.equations_beside(*index, &|i, d| self.scattered(*index, i, d));
            let directions = e.block.columns(p, e.block.ncols() - p).into_owned();
            let scaled = left.values().zip_map(&e.scale, |r, scale| r / scale);
            let (_, rest) = self.beside_scatter(directions, scaled, *index);
            self.weights.rows[*index] * count * rest.norm_squared()
        };
        let each: Vec<f64> = rows.par_iter().zip(&counts).map(one).collect();
        each.iter().sum()
    }

    /// What each solution leaves of a row.
    fn left_of(&self, index: usize, of: &[Solution], used: &[(usize, usize)]) -> Vec<Residual> {
        let beside = |i: usize, d: &Derivatives| {
            let mut all = self.of_moments(i, d);
            all.extend(self.shifts(i, d, of, used));
            all
        };
        let e = self.at.equations_beside(index, &beside);
        let p = self.unknowns();
        let by_moments = self.by_moments(&e);
        let each = of.iter().zip(p..).map(|(solution, shift)| {
            let mut imitated = e.block.columns(0, p) * solution.geometry.rows(0, p);
            imitated -= &by_moments;
            imitated -= e.block.column(shift);
            let values = Values::from_fn(e.rhs.len(), |c| (e.rhs[c] - imitated[c]) * e.scale[c]);
            e.residual.with(values)
        });
        each.collect()
    }

    /// Candidates of which the state or a solution has something, and where their columns
    /// begin.
    fn used(&self, solutions: &[Solution]) -> Vec<(usize, usize)> {
        let some = |c: usize| {
            self.held[c] != 0.0 || solutions.iter().any(|solution| solution.columns[c] != 0.0)
        };
        let mut first = 0;
        let mut out = Vec::new();
        for (k, possible) in self.possible.iter().enumerate() {
            let own = first..first + possible.count();
            if own.clone().any(some) {
                out.push((k, first));
            }
            first = own.end;
        }
        out
    }

    /// How the target moves from the candidates and curves of each solution to those of the
    /// state.
    fn shifts(
        &self,
        index: usize,
        d: &Derivatives,
        of: &[Solution],
        used: &[(usize, usize)],
    ) -> Vec<Vector3<f64>> {
        let bent = self.bent(index, d);
        let by_curves = self.by_curves(index, d, of);
        let columns = used.iter().flat_map(|(k, first)| {
            (*first..).zip(self.possible[*k].columns(self.problem, index, d))
        });
        let columns: Vec<(usize, Vector3<f64>)> = columns.collect();
        let each = of.iter().zip(by_curves).map(|(solution, by_curves)| {
            let by = |c: usize| self.held[c] - solution.columns[c];
            let moved = columns.iter().map(|(c, column)| column * by(*c));
            bent - by_curves + moved.sum::<Vector3<f64>>()
        });
        each.collect()
    }
}
