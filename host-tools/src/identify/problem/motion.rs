//! How targets, and what else a row hangs on, move with the unknowns.

use nalgebra::{DMatrix, DVector, Vector3};
use truearm::Pose;

use super::Problem;
use super::predictor::{Model, View};
use super::unknowns::Unknowns;
use crate::model::arm::Derivatives;
use crate::model::{Instrument, Row};
use crate::observations::{ArmPart, Body, Moving, Partials, Seen};

/// How the target of a row moves with something beside the unknowns, as many columns
/// for every row, SI: linear in the derivatives, which are asked of how it turns, too.
pub type Beside<'b> = dyn Fn(usize, &Derivatives) -> Vec<Vector3<f64>> + Sync + 'b;

/// Calls with every unknown that moves the target of a row and with how it does, SI, by these
/// derivatives and those to the coefficients of terms.
pub fn moving(
    unknowns: &Unknowns,
    row: &Row,
    (d, terms): (&Derivatives, &[Vector3<f64>]),
    with: &mut impl FnMut(usize, &Vector3<f64>),
) {
    let mut set = |first: Option<usize>, columns: &[Vector3<f64>]| {
        first.into_iter().flat_map(|first| first..).zip(columns).for_each(|(k, v)| with(k, v));
    };
    set(unknowns.station(row.station), &d.base);
    set(unknowns.marker(row.marker), &d.tool);
    set(Some(unknowns.terms().start), terms);
    for (i, columns) in d.links.iter().enumerate() {
        set(Some(unknowns.free() + 5 * i), &columns.to_array());
    }
}

/// The targets' motion with the unknowns, in units, and with what is beside.
pub(in crate::identify) struct Motion<'l> {
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

    fn derivatives(&self, index: usize) -> Derivatives {
        self.model.derivatives(self.row(index), self.problem.conditions.row(index))
    }

    /// How what these derivatives at a row are of moves with each unknown in its unit
    /// and with what is beside.
    fn columns(&self, index: usize, d: &Derivatives) -> DMatrix<f64> {
        let (row, problem) = (self.row(index), self.problem);
        let unknowns = &problem.unknowns;
        let beside = (self.beside)(index, d);
        let count = unknowns.list().len();
        let mut block = DMatrix::zeros(3, count + beside.len());
        let terms = match unknowns.terms().is_empty() {
            true => Vec::new(),
            false => self.model.columns(row, problem.conditions.row(index), d),
        };
        let numbers = block.as_mut_slice();
        let mut set = |column: usize, moved: Vector3<f64>| {
            numbers[3 * column..3 * column + 3].copy_from_slice(moved.as_slice());
        };
        moving(unknowns, row, (d, &terms), &mut |column, moved| {
            set(column, moved * self.units[column]);
        });
        beside.iter().enumerate().for_each(|(k, moved)| set(count + k, *moved));
        block
    }

    /// How what a part of a row pulls at moves, as many rows as it has columns.
    fn body(&self, part: &ArmPart) -> DMatrix<f64> {
        let row = part.row;
        let target = self.derivatives(row);
        if part.pull.ncols() == 3 {
            return self.columns(row, &target);
        }
        let turning = target.turning();
        let at = match part.body {
            Body::Target => target,
            Body::Flange => {
                let lever = self.pose(row).rotation * self.marker(row);
                target.behind(&lever, &turning)
            }
        };
        let (moved, turned) = (self.columns(row, &at), self.columns(row, &turning));
        let mut all = DMatrix::zeros(6, moved.ncols());
        all.rows_mut(0, 3).copy_from(&moved);
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
        let d = self.derivatives(index);
        (d.point, self.columns(index, &d))
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
