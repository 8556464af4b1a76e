//! A part of the cell that errs as something recorded goes, by a few smooth functions.

mod covariate;
mod part;
pub mod smooth;

use nalgebra::Vector3;

use crate::identify::Problem;
use crate::model::arm::Derivatives;
pub use covariate::Covariate;
pub use part::Part;
pub use smooth::{Shape, Smooth};

/// A part that errs with a covariate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follows {
    /// What errs.
    pub part: Part,
    /// With what.
    pub with: Covariate,
    /// How.
    pub how: Smooth,
}

/// Numbers of covariates at most: of kinds, and of joints.
const COVARIATES: usize = 32;

impl Follows {
    /// How the target of a row moves with each coefficient, SI: way after way.
    #[must_use]
    pub fn columns(&self, problem: &Problem, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        // Of rows that have none, nothing: nearly all have it, or it is not looked at.
        let at = self.with.within(problem, index, self.how.range).map(|value| self.how.at(value));
        let at = at.unwrap_or_else(|| vec![0.0; self.how.shape.count()]);
        let moves = self.part.moves(problem, index, d);
        moves.iter().flat_map(|way| at.iter().map(move |f| way * *f)).collect()
    }

    /// How many columns.
    #[must_use]
    pub fn count(&self) -> usize {
        self.part.ways() * self.how.shape.count()
    }

    /// A number for the pair.
    #[must_use]
    pub fn number(&self) -> usize {
        self.part.number() * COVARIATES + self.with.number()
    }

    /// What it says.
    #[must_use]
    pub fn words(&self, problem: &Problem) -> String {
        format!("{} as {} goes", self.part.words(problem), self.with.words(problem))
    }
}
