//! How springs bend with the moments of links.

use std::sync::Arc;

use nalgebra::Vector3;
use truearm::effects::{Effect, Term};

use crate::identify::{Problem, Surroundings};
use crate::model::ModelTerm;
use crate::model::arm::{Derivatives, RowInputs};

/// Whether an effect is one that is linear in the moments.
#[must_use]
pub fn bends(name: &str) -> bool {
    let linear = [Effect::JointCompliance, Effect::BaseCompliance, Effect::LateralCompliance];
    linear.iter().any(|e| e.name() == name)
}

/// The same, or one that stiffens: it bends with the moments, if not in proportion.
#[must_use]
pub fn is_spring(name: &str) -> bool {
    bends(name) || name == Effect::JointStiffening.name()
}

/// How a state's springs bend with the moments.
#[derive(Clone)]
pub struct Bending {
    pub(super) springs: Vec<Term<f64>>,
    /// With one more unit of each.
    pub(super) loads: Arc<[Surroundings]>,
    /// What the state has, in units.
    pub(super) found: Vec<f64>,
    pub(super) assumed: bool,
}

impl Bending {
    /// The springs, with their coefficients.
    #[must_use]
    pub fn springs(&self) -> &[Term<f64>] {
        &self.springs
    }

    /// Of some of the springs only; `None` if that is of none.
    #[must_use]
    pub fn only(&self, own: &dyn Fn(&Term<f64>) -> bool) -> Option<Self> {
        let springs: Vec<_> = self.springs.iter().filter(|s| own(s)).copied().collect();
        (!springs.is_empty()).then(|| Self { springs, ..self.clone() })
    }

    /// Whether masses were only assumed.
    #[must_use]
    pub fn is_assumed(&self) -> bool {
        self.assumed
    }

    /// How each spring moves the target of a row, m.
    #[must_use]
    pub fn actions(&self, problem: &Problem, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let (row, here) = (&problem.data.rows[index], &problem.conditions.rows[index]);
        let of =
            |term: &Term<f64>| d.column(term, here, &row.q, &problem.nominal) * term.coefficient;
        self.springs.iter().map(of).collect()
    }

    /// What the state has of each moment, in units.
    #[must_use]
    pub fn found(&self) -> &[f64] {
        &self.found
    }

    /// How the target of a row moves with a unit of each moment, m.
    #[must_use]
    pub fn columns(&self, problem: &Problem, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let row = &problem.data.rows[index];
        let here = &problem.conditions.rows[index];
        let column = |loads: &Surroundings| {
            let there: RowInputs = loads.inputs(row, &row.q);
            let of = |term: &Term<f64>| {
                let at = |inputs| d.column(term, inputs, &row.q, &problem.nominal);
                (at(&there) - at(here)) * term.coefficient
            };
            self.springs.iter().map(of).sum()
        };
        self.loads.iter().map(column).collect()
    }
}

/// A term of the arm, if it is one.
pub(super) fn of_arm(term: &ModelTerm) -> Option<Term<f64>> {
    if let ModelTerm::Arm(term) = term { Some(*term) } else { None }
}
