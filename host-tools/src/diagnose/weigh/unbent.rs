//! What moments of links do, they do to springs: a model without a spring has none of it.
//!
//! Moments are unknowns of geometry while a model with springs is linearised, and all models
//! are weighed with the same geometry. So one with an eccentricity in a spring's place would
//! have what the moments do to that spring besides, and explain as much.

use std::collections::BTreeMap;

use nalgebra::DVector;
use truearm::effects::Term;

use super::joint_curves::Curve;
use super::possible::{Possible, What};
use super::sheet::{Sheet, Weights};
use crate::diagnose::moments::Bending;
use crate::evidence::{Candidate, Explanation, Gram, Subsets};
use crate::identify::{Problem, State};
use crate::model::ModelTerm;

/// Models of less probability than this share of the best's are not weighed again.
const NEAR: f64 = 1e-5;

/// What was weighed.
pub struct At<'s> {
    pub problem: &'s Problem<'s>,
    pub state: &'s State,
    pub rows: &'s [usize],
    pub weights: &'s Weights,
    pub curves: &'s [Curve],
    pub possible: &'s [Possible],
    /// How moments bend the springs of the state; `None` where it has none.
    pub bending: Option<&'s Bending>,
    pub lambda: f64,
}

/// Members of a model, and what its log mass is more than with all springs' moments.
type Changes = BTreeMap<Vec<usize>, f64>;

/// An explanation in which no model has moments that bend a spring it does not have. None gains
/// by it: that a model needs fewer unknowns is no reason to believe that there is no spring,
/// whose load may well be of one link.
#[must_use]
pub fn reweighed(
    at: &At,
    (gram, precision): (&Gram, &DVector<f64>),
    found: Explanation,
) -> Explanation {
    let Some(bending) = at.bending else { return found };
    let springs: Vec<usize> =
        (0..at.possible.len()).filter(|m| at.holds(*m, bending.springs())).collect();
    let least = NEAR * found.posterior.models.first().map_or(1.0, |(_, p)| *p);
    let models = found.posterior.models.iter().filter(|(_, p)| *p > least);
    let mut by_springs: BTreeMap<Vec<usize>, Vec<&[usize]>> = BTreeMap::new();
    for (members, _) in models {
        let own = springs.iter().copied().filter(|s| members.contains(s)).collect();
        by_springs.entry(own).or_default().push(members);
    }
    by_springs.remove(&springs);
    if by_springs.is_empty() {
        return found;
    }
    let mut changes = Changes::new();
    let (with, freedom) = at.masses(&springs, by_springs.values().flatten(), found.scale, None);
    for (own, models) in &by_springs {
        let (without, _) = at.masses(own, models.iter(), found.scale, Some(freedom));
        for (members, mass) in without {
            let more = mass - with.get(&members).copied().unwrap_or(mass);
            changes.insert(members, more.min(0.0));
        }
    }
    let entries: Vec<Candidate> = at.possible.iter().map(|p| p.entry.clone()).collect();
    let all = |members: &[usize]| springs.iter().all(|s| members.contains(s));
    found.reweighed(gram, precision, &entries, &|members| match changes.get(members) {
        Some(change) => *change,
        None if all(members) => 0.0,
        // So improbable before that it was not weighed.
        None => f64::NEG_INFINITY,
    })
}

impl At<'_> {
    /// Whether a candidate is one of these springs.
    fn holds(&self, candidate: usize, springs: &[Term<f64>]) -> bool {
        let What::Effect(own) = &self.possible[candidate].what else { return false };
        let is = |term: &ModelTerm| springs.iter().any(|s| bare(&ModelTerm::Arm(*s)) == bare(term));
        own.terms.iter().any(is)
    }

    /// Whether the state has any of a candidate's terms.
    fn is_in_state(&self, candidate: usize) -> bool {
        let What::Effect(own) = &self.possible[candidate].what else { return false };
        let known = |term: &ModelTerm| self.state.terms.iter().any(|t| bare(t) == bare(term));
        own.terms.iter().any(known)
    }

    /// Log masses of models whose geometry has the moments that bend some springs, and how
    /// many equations that geometry uses up; with so many if told.
    fn masses<'m>(
        &self,
        springs: &[usize],
        models: impl Iterator<Item = &'m &'m [usize]>,
        scale: f64,
        freedom: Option<f64>,
    ) -> (Changes, f64) {
        let models: Vec<&[usize]> = models.copied().collect();
        // What the state has is among them: rows are what is left without its terms.
        let held = (0..self.possible.len()).filter(|m| self.is_in_state(*m));
        let mut members: Vec<usize> = models.iter().copied().flatten().copied().collect();
        members.extend(held);
        members.sort_unstable();
        members.dedup();
        let possible: Vec<Possible> = members.iter().map(|m| self.possible[*m].clone()).collect();
        let own =
            |term: &Term<f64>| springs.iter().any(|s| self.holds(*s, std::slice::from_ref(term)));
        let bending = self.bending.and_then(|bending| bending.only(&own));
        let sheet = Sheet::new(self.problem, self.state, &possible, self.weights, self.curves)
            .bending(bending, self.rows, self.lambda);
        let gram = sheet.gram(self.rows);
        let geometry = gram.geometry(&sheet.precision(self.lambda), scale);
        let mut projected = gram.project(&geometry);
        projected.geometry = freedom.unwrap_or(projected.geometry);
        let freedom = projected.geometry;
        let entries = possible.iter().map(|p| p.entry.clone()).collect();
        let subsets = Subsets::new(projected, entries);
        let of = |model: &&[usize]| {
            let own: Vec<usize> =
                model.iter().filter_map(|m| members.binary_search(m).ok()).collect();
            (model.to_vec(), subsets.fit(&own, &|_| None).log_mass)
        };
        (models.iter().map(of).collect(), freedom)
    }
}

/// A term without its coefficient.
fn bare(term: &ModelTerm) -> ModelTerm {
    let mut term = term.clone();
    *term.coefficient_mut() = 0.0;
    term
}
