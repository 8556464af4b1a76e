//! Rows linearised once, with the columns of every candidate beside those of
//! geometry: all that evidence, folds and halves need.

use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

use super::possible::Possible;
use crate::diagnose::policy::POLICY;
use crate::evidence::poses::{whiten, within};
use crate::evidence::{self, Gram};
use crate::identify::{Linearised, Problem, State};
use crate::model::Values;
use crate::model::arm::Derivatives;
use crate::observations::Residual;

/// Equations given to a Gram matrix at a time.
const TOGETHER: usize = 240;

/// How much each row counts, and what the readings of a pose have in common.
#[derive(Debug, Clone)]
pub struct Weights {
    /// Of each row of the file.
    pub rows: Vec<f64>,
    /// Share of the variance that is common to the readings of a pose.
    pub common: f64,
}

/// A linearised data set.
pub struct Sheet<'a> {
    problem: &'a Problem<'a>,
    at: Linearised<'a>,
    bases: Vec<Vector3<f64>>,
    possible: &'a [Possible],
    /// Coefficient of every column in the state.
    held: DVector<f64>,
    weights: &'a Weights,
}

/// Coefficients of candidates and of geometry that go together.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Of every candidate's columns.
    pub columns: DVector<f64>,
    /// Of geometry, counted from nominal, in units.
    pub geometry: DVector<f64>,
}

impl<'a> Sheet<'a> {
    /// Of `problem`, geometry only, at a state whose terms are among those of
    /// the candidates.
    #[must_use]
    pub fn new(
        problem: &'a Problem<'a>,
        state: &State,
        possible: &'a [Possible],
        weights: &'a Weights,
    ) -> Self {
        let columns = possible.iter().flat_map(Possible::coefficients_zero);
        let held = columns.map(|term| {
            let same = |t: &&crate::model::ModelTerm| {
                let mut t = (*t).clone();
                *t.coefficient_mut() = 0.0;
                term.as_ref() == Some(&t)
            };
            state.terms.iter().find(same).map_or(0.0, |t| t.coefficient())
        });
        Self {
            held: DVector::from_iterator(columns_of(possible), held),
            bases: state.bases.iter().map(|b| b.translation).collect(),
            at: problem.linearise(state),
            problem,
            possible,
            weights,
        }
    }

    /// Diagonal of geometry's prior: tolerances of links, 10 m of a base, 1 m of
    /// a tool.
    #[must_use]
    pub fn precision(&self, lambda: f64) -> DVector<f64> {
        let unknowns = &self.problem.unknowns;
        let of = |(k, unknown): (usize, &crate::identify::Unknown)| {
            let unit = self.problem.unit(*unknown);
            match unknown {
                _ if k >= unknowns.free() => lambda,
                crate::identify::Unknown::Marker(..) => (unit / POLICY.tool_prior).powi(2),
                _ => (unit / POLICY.base_prior).powi(2),
            }
        };
        DVector::from_iterator(unknowns.list().len(), unknowns.list().iter().enumerate().map(of))
    }

    /// Sums over the rows of each part.
    #[must_use]
    pub fn grams(&self, parts: &[Vec<usize>]) -> Vec<Gram> {
        parts.par_iter().map(|rows| self.gram(rows)).collect()
    }

    /// Sums over rows.
    #[must_use]
    pub fn gram(&self, rows: &[usize]) -> Gram {
        let p = self.problem.unknowns.list().len();
        let mut gram = Gram::new(p, self.held.len());
        let mut waiting: Vec<DMatrix<f64>> = Vec::new();
        let mut equations = 0;
        let add = |gram: &mut Gram, waiting: &mut Vec<DMatrix<f64>>| {
            let all = stacked(waiting, p + self.held.len() + 1);
            let columns = p + self.held.len();
            let y = all.column(columns).into_owned();
            gram.add(
                &all.columns(0, p).into_owned(),
                &all.columns(p, self.held.len()).into_owned(),
                &y,
            );
            waiting.clear();
        };
        for readings in self.readings(rows) {
            let (block, repeats) = self.block(&readings);
            gram.add_repeats(repeats.0, repeats.1);
            equations += block.nrows();
            waiting.push(block);
            if equations >= TOGETHER {
                add(&mut gram, &mut waiting);
                equations = 0;
            }
        }
        if !waiting.is_empty() {
            add(&mut gram, &mut waiting);
        }
        gram
    }

    /// Rows that are readings of one target in one pose from one station.
    fn readings(&self, rows: &[usize]) -> Vec<Vec<usize>> {
        let key = |r: &usize| {
            let row = &self.problem.data.rows[*r];
            (row.pose, row.station, row.marker, row.kind.0)
        };
        let mut sorted = rows.to_vec();
        sorted.sort_by_key(|r| (key(r), *r));
        sorted.chunk_by(|a, b| key(a) == key(b)).map(<[usize]>::to_vec).collect()
    }

    /// `[G, Z, y]` of the readings of a pose, weighted and whitened; how many of
    /// its equations repeat others, and what they scatter about their mean.
    fn block(&self, readings: &[usize]) -> (DMatrix<f64>, (usize, f64)) {
        let k = self.held.len();
        let mut parts = Vec::new();
        let mut residual: Vec<f64> = Vec::new();
        for index in readings {
            let e = self.at.equations_beside(*index, &|i, d| self.beside(i, d));
            let (m, p) = (e.block.nrows(), e.block.ncols() - k);
            let weight = self.weights.rows[*index].sqrt();
            let mut part = DMatrix::zeros(m, p + k + 1);
            part.columns_mut(0, p + k).copy_from(&e.block);
            let own = e.block.columns(p, k) * &self.held;
            for c in 0..m {
                part[(c, p + k)] = e.rhs[c] + own[c];
            }
            part *= weight;
            residual.extend(e.scaled_residual().iter().map(|r| r * weight));
            parts.push(part);
        }
        let width = parts[0].ncols();
        let mut block = stacked(&parts, width);
        whiten(&mut block, readings.len(), self.weights.common);
        let mut left = DMatrix::from_vec(residual.len(), 1, residual);
        whiten(&mut left, readings.len(), self.weights.common);
        (block, within(left.as_slice(), readings.len()))
    }

    fn beside(&self, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let of = |possible: &Possible| possible.columns(self.problem, index, d, &self.bases);
        self.possible.iter().flat_map(of).collect()
    }

    /// What geometry is when candidates have these coefficients.
    #[must_use]
    pub fn solved(
        &self,
        gram: &Gram,
        precision: &DVector<f64>,
        scale: f64,
        columns: DVector<f64>,
    ) -> Solution {
        let geometry = gram.geometry(precision, scale).mean(gram, &columns);
        Solution { columns, geometry }
    }

    /// Measured minus predicted of rows, SI.
    #[must_use]
    pub fn left(&self, rows: &[usize], solution: &Solution) -> Vec<(usize, Residual)> {
        let left = |index: &usize| {
            let used = |i: usize, d: &Derivatives| {
                let sum = self.possible.iter().fold((0, Vector3::zeros()), |(first, sum), p| {
                    let count = p.count();
                    let own = first..first + count;
                    let both =
                        own.clone().any(|c| solution.columns[c] != 0.0 || self.held[c] != 0.0);
                    if !both {
                        return (first + count, sum);
                    }
                    let columns = p.columns(self.problem, i, d, &self.bases);
                    let more = own
                        .zip(columns)
                        .map(|(c, column)| column * (self.held[c] - solution.columns[c]));
                    (first + count, sum + more.sum::<Vector3<f64>>())
                });
                vec![sum.1]
            };
            let e = self.at.equations_beside(*index, &used);
            let p = e.block.ncols() - 1;
            let imitated = e.block.columns(0, p) * &solution.geometry;
            let values = Values::from_fn(e.rhs.len(), |c| {
                (e.rhs[c] + e.block[(c, p)] - imitated[c]) * e.scale[c]
            });
            (*index, e.residual.with(values))
        };
        rows.par_iter().map(left).collect()
    }

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

/// Columns of all candidates together.
pub fn columns_of(possible: &[Possible]) -> usize {
    possible.iter().map(Possible::count).sum()
}

fn stacked(parts: &[DMatrix<f64>], width: usize) -> DMatrix<f64> {
    let height = parts.iter().map(DMatrix::nrows).sum();
    let mut out = DMatrix::zeros(height, width);
    let mut first = 0;
    for part in parts {
        out.rows_mut(first, part.nrows()).copy_from(part);
        first += part.nrows();
    }
    out
}
