//! The measured rows as a least-squares problem, linearised at a state.

use nalgebra::{DMatrix, DVector, Matrix3xX, Vector3};
use truearm::{Link, MdhParameters};

use super::unknowns::{State, Unknown, Unknowns};
use crate::chain::Kinematics;
use crate::files::{Measurements, Row};
use crate::tikhonov::Triangle;

/// What lambda weighs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scaling {
    /// Residuals count standard deviations, parameters count tolerances:
    /// lambda = 1 is the maximum a posteriori estimate.
    #[default]
    Prior,
    /// `lambda I` on metres and radians, as the paper prints it.
    Printed,
}

/// A data set and its unknowns.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// The measurements.
    pub data: &'a Measurements,
    /// Nominal links, about which corrections are kept small.
    pub nominal: Vec<Link<f64>>,
    /// Column order.
    pub unknowns: Unknowns,
    /// What lambda weighs.
    pub scaling: Scaling,
}

/// A row's three equations, scaled: `block x = rhs`.
pub struct Equations {
    /// 3 x unknowns.
    pub block: Matrix3xX<f64>,
    /// Right-hand side: residual plus what the current corrections explain, so
    /// that the penalised unknowns are counted from nominal.
    pub rhs: Vector3<f64>,
    /// Measured minus modelled point, m.
    pub residual: Vector3<f64>,
}

impl<'a> Problem<'a> {
    /// Of all rows of `data`.
    #[must_use]
    pub fn new(data: &'a Measurements, nominal: Vec<Link<f64>>, scaling: Scaling) -> Self {
        let unknowns = Unknowns::new(data.stations.len(), data.markers.len(), nominal.len());
        Self { data, nominal, unknowns, scaling }
    }

    /// Size of one unit of each unknown, m or rad.
    #[must_use]
    pub fn unit(&self, unknown: Unknown) -> f64 {
        match (self.scaling, unknown) {
            (Scaling::Printed, Unknown::Link(..)) => 1.0,
            _ => unknown.tolerance(),
        }
    }

    /// All units in column order.
    #[must_use]
    pub fn units(&self) -> DVector<f64> {
        let list = self.unknowns.list();
        DVector::from_fn(list.len(), |k, _| self.unit(list[k]))
    }

    /// Factor of a row's residual.
    fn row_weight(&self, row: &Row) -> f64 {
        match self.scaling {
            Scaling::Prior => 1.0 / row.sigma,
            Scaling::Printed => 1.0,
        }
    }

    /// Metres to one unit of a row's equations.
    #[must_use]
    pub fn metres(&self, row: usize) -> f64 {
        1.0 / self.row_weight(&self.data.rows[row])
    }

    /// Corrections of a state in units, zero for the free unknowns.
    #[must_use]
    pub fn corrections(&self, state: &State) -> DVector<f64> {
        let mut x = DVector::zeros(self.unknowns.list().len());
        for (i, (link, nominal)) in state.links.iter().zip(&self.nominal).enumerate() {
            let (now, then) = (link.parameters.to_array(), nominal.parameters.to_array());
            for k in 0..5 {
                let at = self.unknowns.free() + 5 * i + k;
                x[at] = (now[k] - then[k]) / self.unit(self.unknowns.list()[at]);
            }
        }
        x
    }

    /// Linearises at a state.
    #[must_use]
    pub fn linearise(&self, state: &'a State) -> Linearised<'a> {
        let markers = state.markers.len();
        let pairs = (0..state.bases.len()).flat_map(|s| (0..markers).map(move |m| (s, m)));
        Linearised {
            chains: pairs.map(|(s, m)| state.chain(s, m)).collect(),
            markers,
            corrections: self.corrections(state),
            units: self.units(),
            problem: self.clone(),
        }
    }
}

/// A problem at a state.
pub struct Linearised<'a> {
    problem: Problem<'a>,
    chains: Vec<Box<dyn Kinematics>>,
    markers: usize,
    corrections: DVector<f64>,
    units: DVector<f64>,
}

impl Linearised<'_> {
    fn chain(&self, row: &Row) -> &dyn Kinematics {
        self.chains[row.station * self.markers + row.marker].as_ref()
    }

    /// Measured minus modelled point of a row, m.
    #[must_use]
    pub fn residual(&self, row: usize) -> Vector3<f64> {
        let row = &self.problem.data.rows[row];
        row.point - self.chain(row).pose(&row.q).translation
    }

    /// The equations of a row.
    #[must_use]
    pub fn equations(&self, row: usize) -> Equations {
        let row = &self.problem.data.rows[row];
        let unknowns = &self.problem.unknowns;
        let d = self.chain(row).derivatives(&row.q);
        let mut block = Matrix3xX::zeros(unknowns.list().len());
        let station = unknowns.station(row.station);
        for (k, column) in d.base.iter().enumerate() {
            block.set_column(station + k, column);
        }
        let marker = unknowns.marker(row.marker, self.problem.data.stations.len());
        for (k, column) in d.tool.iter().enumerate() {
            block.set_column(marker + k, column);
        }
        for (i, columns) in d.links.iter().enumerate() {
            for (k, column) in columns.iter().enumerate() {
                block.set_column(unknowns.free() + 5 * i + k, column);
            }
        }
        let weight = self.problem.row_weight(row);
        for (k, unit) in self.units.iter().enumerate() {
            block.column_mut(k).scale_mut(unit * weight);
        }
        let residual = row.point - d.point;
        let rhs = residual * weight + &block * &self.corrections;
        Equations { block, rhs, residual }
    }

    /// Triangle of the given rows, each coordinate multiplied by a weight.
    #[must_use]
    pub fn triangle(&self, rows: &[usize], weights: Option<&[Vector3<f64>]>) -> Triangle {
        let columns = self.units.len();
        let mut matrix = DMatrix::zeros(3 * rows.len(), columns + 1);
        for (i, row) in rows.iter().enumerate() {
            let e = self.equations(*row);
            matrix.view_mut((3 * i, 0), (3, columns)).copy_from(&e.block);
            matrix.view_mut((3 * i, columns), (3, 1)).copy_from(&e.rhs);
            if let Some(weights) = weights {
                for c in 0..3 {
                    matrix.row_mut(3 * i + c).scale_mut(weights[*row][c].sqrt());
                }
            }
        }
        Triangle::new(&matrix)
    }

    /// Corrections at this state, in units.
    #[must_use]
    pub fn corrections(&self) -> &DVector<f64> {
        &self.corrections
    }

    /// From units to m and rad.
    #[must_use]
    pub fn to_si(&self, x: &DVector<f64>) -> DVector<f64> {
        x.component_mul(&self.units)
    }
}

/// Corrections of a state as link parameters.
#[must_use]
pub fn link_corrections(state: &State, nominal: &[Link<f64>]) -> Vec<MdhParameters<f64>> {
    let difference = |(link, nominal): (&Link<f64>, &Link<f64>)| {
        let (now, then) = (link.parameters.to_array(), nominal.parameters.to_array());
        MdhParameters::from_array(core::array::from_fn(|k| now[k] - then[k]))
    };
    state.links.iter().zip(nominal).map(difference).collect()
}
