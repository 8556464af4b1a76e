//! The measured rows as a least-squares problem, linearised at a state.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix3xX, Vector3};
use truearm::effects::Term;
use truearm::{Link, MdhParameters};

use super::conditions::Conditions;
use super::unknowns::{State, Unknown, Unknowns};
use crate::model::ModelTerm;
use crate::model::arm::{Derivatives, Kinematics};
use crate::model::{Measurements, Robot, Row};
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
    /// What terms depend on, row by row.
    pub conditions: Arc<Conditions>,
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
    /// Unscaled derivatives they were made of.
    pub derivatives: Derivatives,
}

impl<'a> Problem<'a> {
    /// Of all rows of `data`, geometry only.
    #[must_use]
    pub fn new(data: &'a Measurements, robot: &Robot, scaling: Scaling) -> Self {
        let nominal = robot.nominal();
        let conditions = Arc::new(Conditions::new(data, robot));
        let unknowns = Unknowns::new(data.stations.len(), data.markers.len(), 0, nominal.len());
        Self { data, conditions, nominal, unknowns, scaling }
    }

    /// The same with so many terms.
    #[must_use]
    pub fn with_terms(&self, terms: usize) -> Self {
        let (stations, markers) = (self.data.stations.len(), self.data.markers.len());
        let unknowns = Unknowns::new(stations, markers, terms, self.nominal.len());
        Self { unknowns, ..self.clone() }
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

    /// Linearises at a state; its terms are held unless the problem has as many.
    #[must_use]
    pub fn linearise(&self, state: &State) -> Linearised<'a> {
        Linearised {
            model: Model::new(state),
            corrections: self.corrections(state),
            units: self.units(),
            problem: self.clone(),
        }
    }
}

/// A state ready to predict rows.
pub struct Model {
    chains: Vec<Box<dyn Kinematics>>,
    markers: usize,
    arm_terms: Vec<Term<f64>>,
    terms: Vec<ModelTerm>,
    bases: Vec<Vector3<f64>>,
}

impl Model {
    /// Of a state.
    #[must_use]
    pub fn new(state: &State) -> Self {
        let markers = state.markers.len();
        let pairs = (0..state.bases.len()).flat_map(|s| (0..markers).map(move |m| (s, m)));
        let arm = |t: &ModelTerm| match t {
            ModelTerm::Arm(term) => Some(*term),
            _ => None,
        };
        Self {
            chains: pairs.map(|(s, m)| state.chain(s, m)).collect(),
            markers,
            arm_terms: state.terms.iter().filter_map(arm).collect(),
            terms: state.terms.clone(),
            bases: state.bases.iter().map(|b| b.translation).collect(),
        }
    }

    fn chain(&self, row: &Row) -> &dyn Kinematics {
        self.chains[row.station * self.markers + row.marker].as_ref()
    }

    /// Where the model sees the target of row `index`, m.
    #[must_use]
    pub fn point(&self, row: &Row, index: usize, conditions: &Conditions) -> Vector3<f64> {
        let inputs = &conditions.rows[index];
        if self.arm_terms.len() == self.terms.len() {
            return self.chain(row).bent(&row.q, &self.arm_terms, inputs).translation;
        }
        self.derivatives(row, index, conditions).0.point
    }

    /// The same with all derivatives, those of the terms in their order.
    #[must_use]
    pub fn derivatives(
        &self,
        row: &Row,
        index: usize,
        conditions: &Conditions,
    ) -> (Derivatives, Vec<Vector3<f64>>) {
        let inputs = &conditions.rows[index];
        let (mut d, arm) = self.chain(row).derivatives(&row.q, &self.arm_terms, inputs);
        let mut arm = arm.into_iter();
        let mut shift = Vector3::zeros();
        let mut columns = Vec::with_capacity(self.terms.len());
        for term in &self.terms {
            let column = match term {
                ModelTerm::Arm(_) => arm.next().unwrap_or_else(Vector3::zeros),
                _ => {
                    let column = measurement_column(term, row, &d, &self.bases[row.station]);
                    shift += column * term.coefficient();
                    column
                }
            };
            columns.push(column);
        }
        d.point += shift;
        (d, columns)
    }
}

/// Derivative of the seen point to a term of the measurement.
#[must_use]
pub fn measurement_column(
    term: &ModelTerm,
    row: &Row,
    d: &Derivatives,
    base: &Vector3<f64>,
) -> Vector3<f64> {
    match term {
        ModelTerm::Arm(_) => Vector3::zeros(),
        ModelTerm::Drift { component, .. } => {
            let hours = row.time.unwrap_or(0.0) / 3600.0;
            let axis = Vector3::ith(component % 3, 1.0);
            hours * if *component < 3 { axis.cross(&(d.point - base)) } else { axis }
        }
        ModelTerm::Remount { series, axis, .. } => {
            if row.series.as_ref() == Some(series) {
                d.tool[*axis]
            } else {
                Vector3::zeros()
            }
        }
    }
}

/// A problem at a state.
pub struct Linearised<'a> {
    problem: Problem<'a>,
    model: Model,
    corrections: DVector<f64>,
    units: DVector<f64>,
}

impl Linearised<'_> {
    /// Measured minus modelled point of a row, m.
    #[must_use]
    pub fn residual(&self, row: usize) -> Vector3<f64> {
        let r = &self.problem.data.rows[row];
        r.point - self.model.point(r, row, &self.problem.conditions)
    }

    /// The equations of a row.
    #[must_use]
    pub fn equations(&self, index: usize) -> Equations {
        let row = &self.problem.data.rows[index];
        let unknowns = &self.problem.unknowns;
        let (d, terms) = self.model.derivatives(row, index, &self.problem.conditions);
        let mut block = Matrix3xX::zeros(unknowns.list().len());
        let station = unknowns.station(row.station);
        for (k, column) in d.base.iter().enumerate() {
            block.set_column(station + k, column);
        }
        let marker = unknowns.marker(row.marker, self.problem.data.stations.len());
        for (k, column) in d.tool.iter().enumerate() {
            block.set_column(marker + k, column);
        }
        for (k, column) in unknowns.terms().zip(&terms) {
            block.set_column(k, column);
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
        Equations { block, rhs, residual, derivatives: d }
    }

    /// `[A, b]` of the given rows, each coordinate multiplied by a weight.
    #[must_use]
    pub fn rows(&self, rows: &[usize], weights: Option<&[Vector3<f64>]>) -> DMatrix<f64> {
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
        matrix
    }

    /// Triangle of the same.
    #[must_use]
    pub fn triangle(&self, rows: &[usize], weights: Option<&[Vector3<f64>]>) -> Triangle {
        Triangle::new(&self.rows(rows, weights))
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
