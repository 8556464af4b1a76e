//! What a solution leaves of rows, to first order.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::{Sheet, Solution, counted};
use crate::model::Values;
use crate::model::arm::Derivatives;
use crate::observations::{Residual, postures};

impl Sheet<'_> {
    /// Measured minus predicted of rows, SI.
    #[must_use]
    pub fn left(&self, rows: &[usize], solution: &Solution) -> Vec<(usize, Residual)> {
        rows.par_iter().map(|index| (*index, self.left_of(*index, solution))).collect()
    }

    /// Sum of squares of the same in standard deviations, each kind's by its own noise.
    #[must_use]
    pub fn misfit(&self, rows: &[usize], solution: &Solution) -> f64 {
        let left = self.left(rows, solution);
        let square = |(row, left): &(usize, Residual)| {
            left.values().zip_map(&self.problem.scale(*row), |r, scale| r / scale).norm_squared()
        };
        left.iter().map(square).sum()
    }

    /// Sum of squares of what is left of these rows, by the noise that the evidence has: tails
    /// count for little, readings of a pose as little more than one, and what joints scatter
    /// along its direction.
    #[must_use]
    pub fn weighed(&self, rows: &[usize], left: &[Option<Residual>]) -> f64 {
        let p = self.problem.unknowns.list().len();
        let counts = counted(self.problem, rows, self.weights.common);
        let one = |(index, count): (&usize, &f64)| {
            let Some(left) = left[*index].as_ref() else { return 0.0 };
            let e = self.at.equations_beside(*index, &|i, d| self.scattered(*index, i, d));
            let directions = e.block.columns(p, e.block.ncols() - p).into_owned();
            let ends = postures(&self.problem.data.rows, &[*index]).len();
            let scaled = left.values().zip_map(&e.scale, |r, scale| r / scale);
            let (_, rest) = self.beside_scatter(directions, scaled, ends);
            self.weights.rows[*index] * count * rest.norm_squared()
        };
        let each: Vec<f64> = rows.par_iter().zip(&counts).map(one).collect();
        each.iter().sum()
    }

    fn left_of(&self, index: usize, solution: &Solution) -> Residual {
        let used = |i: usize, d: &Derivatives| {
            let mut all = self.of_moments(i, d);
            all.push(self.shift(i, d, solution));
            all
        };
        let e = self.at.equations_beside(index, &used);
        let p = self.unknowns();
        let mut imitated = e.block.columns(0, p) * solution.geometry.rows(0, p);
        imitated -= self.by_moments(&e);
        imitated -= e.block.column(p);
        let values = Values::from_fn(e.rhs.len(), |c| (e.rhs[c] - imitated[c]) * e.scale[c]);
        e.residual.with(values)
    }

    /// How the target moves from a solution's candidates and curves to those of the state.
    fn shift(&self, index: usize, d: &Derivatives, solution: &Solution) -> Vector3<f64> {
        let mut first = 0;
        let mut sum = self.bent(index, d) - self.by_curves(index, d, solution);
        for possible in self.possible {
            let own = first..first + possible.count();
            first = own.end;
            let by = |c: usize| self.held[c] - solution.columns[c];
            if own.clone().any(|c| solution.columns[c] != 0.0 || self.held[c] != 0.0) {
                let columns = possible.columns(self.problem, index, d);
                sum += own.zip(columns).map(|(c, column)| column * by(c)).sum::<Vector3<f64>>();
            }
        }
        sum
    }
}
