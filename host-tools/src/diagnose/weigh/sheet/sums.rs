//! Sums over the rows: their equations with the columns of candidates, pose by pose.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::Sheet;
use crate::diagnose::weigh::curve;
use crate::evidence::Gram;
use crate::evidence::poses::{Repeats, whiten};
use crate::identify::problem::accumulate::tree;
use crate::model::Values;
use crate::observations::{by_pose, repeat};

/// Equations given to a Gram matrix at a time, and rows that a task sums.
pub(super) const TOGETHER: usize = 240;

/// Poses that one task sums.
pub(super) const PART: usize = 400;

/// How a block of rows, and what it says of the noise, adds to something.
type Add<'a, T> = dyn Fn(&mut T, &DMatrix<f64>, &Repeats) + Sync + 'a;

impl Sheet<'_> {
    /// Sums over the rows of each part.
    #[must_use]
    pub fn grams(&self, parts: &[Vec<usize>]) -> Vec<Gram> {
        parts.par_iter().map(|rows| self.gram(rows)).collect()
    }

    /// Sums over rows, on all cores, in an order that the rows alone decide.
    #[must_use]
    pub fn gram(&self, rows: &[usize]) -> Gram {
        let [p, k] = self.size();
        let add = |gram: &mut Gram, all: &DMatrix<f64>, repeats: &Repeats| {
            gram.add_repeats(repeats);
            gram.add_block(all);
        };
        let join = |mut a: Gram, b: Gram| {
            a.join(&b);
            a
        };
        self.summed(rows, None, (&|| Gram::new(p, k), &add), &join)
    }

    /// Something that blocks of rows add to, on all cores.
    pub(super) fn summed<T: Send>(
        &self,
        rows: &[usize],
        other: Option<&Sheet>,
        (none, add): (&(dyn Fn() -> T + Sync), &Add<'_, T>),
        join: &(impl Fn(T, T) -> T + Sync),
    ) -> T {
        let of_rows = |places: &Vec<usize>| places.iter().map(|k| rows[*k]).collect();
        let readings: Vec<Vec<usize>> =
            by_pose(&self.problem.data.rows, rows).iter().map(of_rows).collect();
        let all: Vec<usize> = (0..readings.len()).collect();
        let leaf = |own: &[usize]| {
            let mut sum = none();
            let poses = own.iter().map(|k| &readings[*k][..]);
            self.stacks(poses, other, &mut |all, repeats| add(&mut sum, all, repeats));
            sum
        };
        tree(&all, PART, &leaf, join)
    }

    /// Blocks of the readings of some poses, a few hundred equations at a time.
    fn stacks<'r>(
        &self,
        poses: impl Iterator<Item = &'r [usize]>,
        other: Option<&Sheet>,
        add: &mut dyn FnMut(&DMatrix<f64>, &Repeats),
    ) {
        let mut waiting: Vec<DMatrix<f64>> = Vec::new();
        let (mut equations, mut together) = (0, Repeats::default());
        for readings in poses {
            let (block, repeats) = self.block(readings, other);
            together.join(&repeats);
            equations += block.nrows();
            waiting.push(block);
            if equations >= TOGETHER {
                add(&stacked(&waiting), &std::mem::take(&mut together));
                waiting.clear();
                equations = 0;
            }
        }
        if !waiting.is_empty() {
            add(&stacked(&waiting), &together);
        }
    }

    /// `[G, Z, y]` of the readings of a pose, weighted and whitened, and what they say of
    /// the noise. What moments bend in another sheet stands before y.
    fn block(&self, readings: &[usize], other: Option<&Sheet>) -> (DMatrix<f64>, Repeats) {
        let mut parts = Vec::new();
        let mut residual: Vec<f64> = Vec::new();
        for index in readings {
            let weight = self.weights.rows[*index].sqrt();
            let (mut part, own) = self.part(*index, other);
            residual.extend(own.iter().map(|r| r * weight));
            part *= weight;
            parts.push(part);
        }
        let mut block = match <[_; 1]>::try_from(parts) {
            Ok([part]) => part,
            Err(parts) => stacked(&parts),
        };
        // What corners of an image or targets are apart is evidence as any other.
        if !repeat(&self.problem.data.rows, readings) {
            return (self.of_targets(block, readings), Repeats::default());
        }
        whiten(&mut block, readings.len(), self.weights.common);
        let mut left = DMatrix::from_vec(residual.len(), 1, residual);
        whiten(&mut left, readings.len(), self.weights.common);
        let [p, _] = self.size();
        let differing: Vec<usize> = self.differing.iter().map(|column| p + column).collect();
        let mut differing = block.select_columns(&differing).insert_column(differing.len(), 0.0);
        let last = differing.ncols() - 1;
        differing.column_mut(last).copy_from(&left.column(0));
        let repeats = Repeats::of(differing, readings.len(), self.weights.common);
        (block, repeats)
    }

    /// `[G, Z, y]` of a row and its residual.
    fn part(&self, index: usize, other: Option<&Sheet>) -> (DMatrix<f64>, Values) {
        let e = self.at.equations_beside(index, &|i, d| {
            let mut all = self.of_moments(i, d);
            let (candidates, curves) = (self.beside(i, d), self.of_curves(i, d));
            all.extend(
                if self.apart { [candidates, curves] } else { [curves, candidates] }.concat(),
            );
            all.extend(other.into_iter().flat_map(|other| other.of_moments(i, d)));
            all.push(self.bent(i, d));
            all.extend(self.scattered(index, i, d));
            all
        });
        let (p, k) = (self.unknowns(), self.held.len());
        let curves = curve::columns(self.curves);
        let first = if self.apart { p } else { p + curves };
        let last = p + k + curves + other.map_or(0, |other| other.held_moments.len());
        let y = e.block.columns(first, k) * &self.held + self.by_moments(&e) + e.block.column(last);
        let residual = e.scaled_residual();
        let mut part = e.block;
        for component in 0..y.len() {
            part[(component, last)] = e.rhs[component] + y[component];
        }
        self.beside_scatter(part, residual, index)
    }
}

/// One below the other.
fn stacked(parts: &[DMatrix<f64>]) -> DMatrix<f64> {
    let height = parts.iter().map(DMatrix::nrows).sum();
    let mut out = DMatrix::zeros(height, parts.first().map_or(0, DMatrix::ncols));
    let mut first = 0;
    for part in parts {
        out.rows_mut(first, part.nrows()).copy_from(part);
        first += part.nrows();
    }
    out
}
