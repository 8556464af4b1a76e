//! What candidates explain with coefficients fitted to any part of the rows.

use nalgebra::{DMatrix, DVector};

use super::possible::{Possible, columns_of, columns_of_member};
use super::sheet::{Sheet, Solution};
use crate::diagnose::question::Question;
use crate::evidence::{Coefficient, Effort, Explanation, Geometry, Gram, Noise, Subset, Subsets};
use crate::model::ErrorCurve;

/// How far the search goes: arms with random-like gear curves take many lines.
pub const EFFORT: Effort = Effort { beam: 4, branches: 6, of_a_name: 2, members: 40, detours: 240 };
/// The same at first: with a dozen members it may be that joints err by a curve.
pub const FIRST: Effort = Effort { members: 12, ..EFFORT };
/// The same without a fold, where only what is predicted counts and not which
/// of two look-alikes does it.
pub const FOLD: Effort = Effort { beam: 1, branches: 3, of_a_name: 2, members: 40, detours: 40 };
/// Prior size of a candidate that is not in the best model, of [`SIZES`]: 5 floors.
///
/// [`SIZES`]: crate::evidence::prior::SIZES
const USUAL_SIZE: usize = 2;

/// A linearised data set with its candidates.
pub struct Explained<'s, 'a> {
    /// What is asked.
    pub q: &'s Question<'a>,
    /// Candidates.
    pub possible: &'s [Possible],
    /// Their columns.
    pub sheet: &'s Sheet<'s>,
    /// Diagonal of geometry's prior.
    pub precision: &'s DVector<f64>,
}

/// Sums over some rows, ready for any members.
pub struct Part {
    gram: Gram,
    geometry: Geometry,
    noise: Noise,
}

impl Explained<'_, '_> {
    /// Sums at a noise scale.
    #[must_use]
    pub fn part(&self, gram: Gram, scale: f64) -> Part {
        let geometry = gram.geometry(self.precision, scale);
        Part { noise: gram.noise(&geometry), gram, geometry }
    }

    /// Members at prior sizes, fitted to some rows.
    fn at_sizes(&self, part: &Part, members: &[usize], sizes: &[usize]) -> (Subsets, Subset) {
        let columns: Vec<usize> =
            members.iter().flat_map(|m| columns_of_member(self.possible, *m)).collect();
        let entries = members.iter().map(|m| self.possible[*m].entry.clone()).collect();
        let projected = part.gram.project_some((&part.geometry, part.noise), &columns);
        let subsets = Subsets::new(projected, entries);
        let all: Vec<usize> = (0..members.len()).collect();
        let subset = subsets.at_sizes(&all, sizes);
        (subsets, subset)
    }

    /// Coefficients of the `k`-th member of a subset, fitted to some rows, and their
    /// covariance, in SI.
    #[must_use]
    pub fn block(&self, part: &Part, of: &Subset, k: usize) -> (DVector<f64>, DMatrix<f64>) {
        let (subsets, subset) = self.at_sizes(part, &of.members, &of.sizes);
        subsets.block(&subset, k)
    }

    /// The most probable model's coefficients as those of all columns.
    #[must_use]
    pub fn solution(&self, gram: &Gram, geometry: &Geometry, found: &Explanation) -> Solution {
        self.of_subset(gram, geometry, &found.best, &found.coefficients)
    }

    /// The coefficients of a subset as those of all columns.
    #[must_use]
    pub fn of_subset(
        &self,
        gram: &Gram,
        geometry: &Geometry,
        subset: &Subset,
        coefficients: &[Vec<Coefficient>],
    ) -> Solution {
        let each = subset.members.iter().zip(coefficients);
        let values = each.map(|(m, c)| (*m, c.iter().map(|c| c.value).collect()));
        self.spread(gram, geometry, values.collect())
    }

    fn spread(&self, gram: &Gram, geometry: &Geometry, of: Vec<(usize, Vec<f64>)>) -> Solution {
        let mut columns = DVector::zeros(columns_of(self.possible));
        for (member, values) in of {
            let own = columns_of_member(self.possible, member);
            own.zip(values).for_each(|(column, value)| columns[column] = value);
        }
        Solution { geometry: geometry.mean(gram, &columns), columns }
    }

    /// Members refitted to some rows, their prior sizes as they are in the whole:
    /// coefficients, their deviations, and what geometry goes with them. Rows that
    /// say nothing of a coefficient leave it as uncertain as its prior.
    #[must_use]
    pub fn refitted(
        &self,
        part: &Part,
        found: &Explanation,
        members: &[usize],
    ) -> (Vec<Vec<Coefficient>>, Solution) {
        let size = |m: &usize| {
            let place = found.best.members.iter().position(|own| own == m);
            place.map_or(USUAL_SIZE, |k| found.best.sizes[k])
        };
        let sizes: Vec<usize> = members.iter().map(size).collect();
        let (subsets, subset) = self.at_sizes(part, members, &sizes);
        let coefficients = subsets.coefficients(&subset);
        let values = members
            .iter()
            .zip(&coefficients)
            .map(|(m, c)| (*m, c.iter().map(|c| c.value).collect()))
            .collect();
        (coefficients, self.spread(&part.gram, &part.geometry, values))
    }

    /// The curves that go with members refitted to some rows.
    #[must_use]
    pub fn tables(&self, part: &Part, found: &Explanation, members: &[usize]) -> Vec<ErrorCurve> {
        let (_, solution) = self.refitted(part, found, members);
        self.sheet.tables(&solution, &part.geometry)
    }
}
