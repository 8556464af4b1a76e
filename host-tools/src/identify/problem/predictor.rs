//! Where a state sees the targets, and how they move with its unknowns.

use nalgebra::{Rotation3, Vector3};
use truearm::Pose;
use truearm::effects::Term;

use super::conditions::Conditions;
use super::unknowns::State;
use crate::model::arm::{Derivatives, Kinematics, RowInputs};
use crate::model::{Instrument, Measurements, ModelTerm, Row};
use crate::observations::Seen;

/// A state ready to predict rows.
pub struct Model {
    chains: Vec<Box<dyn Kinematics>>,
    markers: usize,
    arm_terms: Vec<Term<f64>>,
    terms: Vec<ModelTerm>,
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
            places: state.markers.clone(),
            instruments: state.instruments.clone(),
        }
    }

    fn chain(&self, row: &Row) -> &dyn Kinematics {
        self.chains[row.station * self.markers + row.marker].as_ref()
    }

    /// Where the model sees the target of a row, m.
    #[must_use]
    pub fn point(&self, row: &Row, inputs: &RowInputs) -> Vector3<f64> {
        if self.arm_terms.len() == self.terms.len() {
            return self.chain(row).bent(&row.q, &self.arm_terms, inputs).translation;
        }
        self.derivatives(row, inputs).point
    }

    /// The same with how the last frame is turned.
    #[must_use]
    pub fn pose(&self, row: &Row, index: usize, conditions: &Conditions) -> Pose<f64> {
        let inputs = conditions.row(index);
        let bent = self.chain(row).bent(&row.q, &self.arm_terms, inputs);
        if self.arm_terms.len() == self.terms.len() {
            return bent;
        }
        let d = self.chain(row).derivatives(&row.q, &self.arm_terms, inputs);
        let turn = Rotation3::from_scaled_axis(self.measured(row, &d.turning()));
        let translation = d.point + self.measured(row, &d);
        Pose { rotation: turn.matrix() * bent.rotation, translation }
    }

    /// Where the target of a row is in the last frame, m: the place of its marker, and
    /// how it was seated.
    #[must_use]
    pub fn marker(&self, row: &Row) -> Vector3<f64> {
        let seated = |term: &ModelTerm| match term {
            ModelTerm::Remount { series, axis, coefficient }
                if row.series.as_ref() == Some(series) =>
            {
                Vector3::ith(*axis, *coefficient)
            }
            _ => Vector3::zeros(),
        };
        self.places[row.marker] + self.terms.iter().map(seated).sum::<Vector3<f64>>()
    }

    /// What rows refer to.
    #[must_use]
    pub fn instruments(&self) -> &[Instrument] {
        &self.instruments
    }

    /// The same with all derivatives.
    #[must_use]
    pub fn derivatives(&self, row: &Row, inputs: &RowInputs) -> Derivatives {
        let mut d = self.chain(row).derivatives(&row.q, &self.arm_terms, inputs);
        d.point += self.measured(row, &d);
        d
    }

    /// What the terms of the measurement do together, by these derivatives.
    fn measured(&self, row: &Row, d: &Derivatives) -> Vector3<f64> {
        self.terms.iter().map(|term| measurement_column(term, row, d) * term.coefficient()).sum()
    }

    /// Derivatives to the coefficients of all terms in their order, by these of the row.
    #[must_use]
    pub fn columns(&self, row: &Row, inputs: &RowInputs, d: &Derivatives) -> Vec<Vector3<f64>> {
        let mut of_arm = self.chain(row).columns(d, &row.q, &self.arm_terms, inputs).into_iter();
        let column = |term: &ModelTerm| match term {
            ModelTerm::Arm(_) => of_arm.next().unwrap_or_else(Vector3::zeros),
            _ => measurement_column(term, row, d),
        };
        self.terms.iter().map(column).collect()
    }
}

/// To the coefficient of a term of the measurement, by derivatives of where the target
/// is seen or of how it is turned; nothing of a term of the arm.
#[must_use]
pub fn measurement_column(term: &ModelTerm, row: &Row, d: &Derivatives) -> Vector3<f64> {
    match term {
        ModelTerm::Drift { component, course, .. } => d.base[*component] * course.at(row),
        ModelTerm::Lag { joint, .. } => {
            let side = row.directions.get(*joint).copied().unwrap_or(0);
            d.links[*joint].theta * f64::from(side)
        }
        ModelTerm::Remount { series, axis, .. } if row.series.as_ref() == Some(series) => {
            d.tool[*axis]
        }
        ModelTerm::Remount { .. } | ModelTerm::Arm(_) => Vector3::zeros(),
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
        self.model.point(self.row(index), self.conditions.row(index))
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
