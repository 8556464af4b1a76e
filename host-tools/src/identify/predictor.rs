//! Where a state sees the targets, and how they move with its unknowns.

use nalgebra::Vector3;
use truearm::Pose;
use truearm::effects::Term;

use super::conditions::Conditions;
use super::unknowns::State;
use crate::model::arm::{Derivatives, Kinematics};
use crate::model::{Instrument, Measurements, ModelTerm, Row};
use crate::observations::Seen;

/// A state ready to predict rows.
pub struct Model {
    chains: Vec<Box<dyn Kinematics>>,
    markers: usize,
    arm_terms: Vec<Term<f64>>,
    terms: Vec<ModelTerm>,
    bases: Vec<Vector3<f64>>,
    places: Vec<Vector3<f64>>,
    instruments: Vec<Instrument>,
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
            places: state.markers.clone(),
            instruments: state.instruments.clone(),
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

    /// The same with how the last frame is turned.
    #[must_use]
    pub fn pose(&self, row: &Row, index: usize, conditions: &Conditions) -> Pose<f64> {
        let inputs = &conditions.rows[index];
        let pose = self.chain(row).bent(&row.q, &self.arm_terms, inputs);
        Pose { translation: self.point(row, index, conditions), ..pose }
    }

    /// Of a marker its place in the last frame, m.
    #[must_use]
    pub fn marker(&self, row: &Row) -> Vector3<f64> {
        self.places[row.marker]
    }

    /// What rows refer to.
    #[must_use]
    pub fn instruments(&self) -> &[Instrument] {
        &self.instruments
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
        ModelTerm::Drift { component, course, .. } => {
            let axis = Vector3::ith(component % 3, 1.0);
            course.at(row) * if *component < 3 { axis.cross(&(d.point - base)) } else { axis }
        }
        ModelTerm::Lag { joint, .. } => {
            let side = row.directions.get(*joint).copied().unwrap_or(0);
            d.links[*joint].theta * f64::from(side)
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

/// A model's view of a file.
pub struct View<'a> {
    /// Where it sees targets.
    pub model: &'a Model,
    /// The file.
    pub data: &'a Measurements,
    /// What terms depend on, row by row.
    pub conditions: &'a Conditions,
}

impl Seen for View<'_> {
    fn row(&self, index: usize) -> &Row {
        &self.data.rows[index]
    }

    fn point(&self, index: usize) -> Vector3<f64> {
        self.model.point(self.row(index), index, self.conditions)
    }

    fn pose(&self, index: usize) -> Pose<f64> {
        self.model.pose(self.row(index), index, self.conditions)
    }

    fn marker(&self, index: usize) -> Vector3<f64> {
        self.model.marker(self.row(index))
    }

    fn instrument(&self, index: usize) -> &Instrument {
        &self.model.instruments()[index]
    }
}
