//! How targets, and what else a row hangs on, move with the unknowns.

use nalgebra::{DMatrix, DVector, Vector3};
use truearm::Pose;

use super::predictor::{Model, View};
use super::problem::Problem;
use crate::model::arm::Derivatives;
use crate::model::{Instrument, Row};
use crate::observations::{ArmPart, Body, Moving, Partials, Seen};

/// Points that move with something beside the unknowns: as many columns for
/// every row, SI.
pub type Beside<'b> = dyn Fn(usize, &Derivatives) -> Vec<Vector3<f64>> + Sync + 'b;

/// The targets' motion with the unknowns, in units, and with what is beside.
pub(super) struct Motion<'l> {
    pub problem: &'l Problem<'l>,
    pub model: &'l Model,
    /// Of the unknowns, SI.
    pub units: &'l DVector<f64>,
    pub beside: &'l Beside<'l>,
}

impl Motion<'_> {
    fn view(&self) -> View<'_> {
        let Problem { data, conditions, .. } = self.problem;
        View { model: self.model, data, conditions }
    }

    /// Where the arm stands at a row, and how the row's target moves with each
    /// unknown in its unit and with what is beside, m.
    fn place(&self, index: usize) -> (Derivatives, DMatrix<f64>) {
        let (row, problem) = (self.row(index), self.problem);
        let unknowns = &problem.unknowns;
        let (d, terms) = self.model.derivatives(row, index, &problem.conditions);
        let beside = (self.beside)(index, &d);
        let count = unknowns.list().len();
        let mut block = DMatrix::zeros(3, count + beside.len());
        let mut set = |first: Option<usize>, columns: &[Vector3<f64>]| {
            for (column, value) in first.into_iter().flat_map(|first| first..).zip(columns) {
                block.column_mut(column).copy_from(value);
            }
        };
        set(unknowns.station(row.station), &d.base);
        set(unknowns.marker(row.marker), &d.tool);
        if !unknowns.terms().is_empty() {
            set(Some(unknowns.terms().start), &terms);
        }
        for (i, columns) in d.links.iter().enumerate() {
            set(Some(unknowns.free() + 5 * i), &columns.to_array());
        }
        set(Some(count), &beside);
        self.in_units(&mut block);
        (d, block)
    }

    /// How the last frame of a row turns with each unknown in its unit, rad;
    /// terms, and what is beside, turn nothing.
    fn turned(&self, index: usize, d: &Derivatives, columns: usize) -> DMatrix<f64> {
        let (row, unknowns) = (self.row(index), &self.problem.unknowns);
        let mut block = DMatrix::zeros(3, columns);
        if let Some(first) = unknowns.station(row.station) {
            (0..3).for_each(|k| block[(k, first + k)] = 1.0);
        }
        for (i, link) in d.turns().iter().enumerate() {
            for (k, column) in link.iter().enumerate() {
                block.column_mut(unknowns.free() + 5 * i + k).copy_from(column);
            }
        }
        self.in_units(&mut block);
        block
    }

    fn in_units(&self, block: &mut DMatrix<f64>) {
        for (mut column, unit) in block.column_iter_mut().zip(self.units) {
            column *= *unit;
        }
    }

    /// How what a part of a row pulls at moves, as many rows as it has columns.
    fn body(&self, part: &ArmPart) -> DMatrix<f64> {
        let (d, mut point) = self.place(part.row);
        if part.pull.ncols() == 3 {
            return point;
        }
        let turned = self.turned(part.row, &d, point.ncols());
        if part.body == Body::Flange {
            let lever = self.pose(part.row).rotation * self.marker(part.row);
            point += lever.cross_matrix() * &turned;
            if let Some(first) = self.problem.unknowns.marker(self.row(part.row).marker) {
                point.columns_mut(first, 3).fill(0.0);
            }
        }
        let mut all = DMatrix::zeros(6, point.ncols());
        all.rows_mut(0, 3).copy_from(&point);
        all.rows_mut(3, 3).copy_from(&turned);
        all
    }
}

impl Seen for Motion<'_> {
    fn row(&self, index: usize) -> &Row {
        &self.problem.data.rows[index]
    }

    fn point(&self, index: usize) -> Vector3<f64> {
        self.view().point(index)
    }

    fn pose(&self, index: usize) -> Pose<f64> {
        self.view().pose(index)
    }

    fn marker(&self, index: usize) -> Vector3<f64> {
        self.model.marker(self.row(index))
    }

    fn instrument(&self, index: usize) -> &Instrument {
        &self.model.instruments()[index]
    }
}

impl Moving for Motion<'_> {
    fn moved(&self, index: usize) -> (Vector3<f64>, DMatrix<f64>) {
        let (d, block) = self.place(index);
        (d.point, block)
    }

    fn block(&self, partials: &Partials) -> DMatrix<f64> {
        let unknowns = &self.problem.unknowns;
        let mut block = DMatrix::zeros(0, 0);
        for part in &partials.arm {
            let moved = &part.pull * self.body(part);
            block = if block.is_empty() { moved } else { block + moved };
        }
        for (instrument, pull) in &partials.instruments {
            for (column, k) in unknowns.instrument(*instrument) {
                let moved = pull.column(k) * self.units[column];
                let mut sum = block.column_mut(column);
                sum += moved;
            }
        }
        block
    }
}
