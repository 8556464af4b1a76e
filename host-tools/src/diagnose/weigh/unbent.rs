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

/// An explanation in which no model has moments that bend a spring it does not have. That it
/// needs fewer unknowns makes up for what it explains less, but no model gains by it: a
/// spring's load may well be of one link, and then does what an eccentricity does.
#[must_use]
pub fn reweighed(
    at: &At,
    (gram, precision): (&Gram, &DVector<f64>),
    found: Explanation,
) -> Explanation {
    let Some(bending) = at.bending else { return found };
    let bent: Vec<ModelTerm> = bending.springs().iter().copied().map(ModelTerm::Arm).collect();
    let springs: Vec<usize> = (0..at.possible.len()).filter(|m| at.has(*m, &bent)).collect();
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
    // What was too improbable to be weighed again loses what the best of its springs does.
    let mut of_others: BTreeMap<Vec<usize>, f64> = BTreeMap::new();
    for (own, models) in &by_springs {
        let with = at.weighed(&springs, models, found.scale, None);
        let without = at.weighed(own, models, found.scale, Some(with.freedom));
        let fewer = 0.5 * (with.log_det - without.log_det);
        let each = models.iter().zip(with.masses.iter().zip(&without.masses));
        let each = each
            .map(|(model, (with, without))| (model.to_vec(), (without - with + fewer).min(0.0)));
        let each: Vec<_> = each.collect();
        let least = each.iter().map(|(_, change)| *change).fold(f64::NEG_INFINITY, f64::max);
        of_others.insert(own.clone(), least);
        changes.extend(each);
    }
    let entries: Vec<Candidate> = at.possible.iter().map(|p| p.entry.clone()).collect();
    let change = |members: &[usize]| {
        let own: Vec<usize> = springs.iter().copied().filter(|s| members.contains(s)).collect();
        changes.get(members).or_else(|| of_others.get(&own)).copied().unwrap_or(0.0)
    };
    found.reweighed(gram, precision, &entries, &change)
}

/// Models weighed under one geometry.
struct Weighing {
    /// Log mass of each, without what is common to all.
    masses: Vec<f64>,
    /// `log |G'G / k^2 + Lambda|`; the prior's of a moment is 0.
    log_det: f64,
    /// Equations that geometry uses up.
    freedom: f64,
}

impl At<'_> {
    /// Whether a candidate has any of these terms, whatever their coefficients.
    fn has(&self, candidate: usize, terms: &[ModelTerm]) -> bool {
        let What::Effect(own) = &self.possible[candidate].what else { return false };
        own.terms.iter().any(|term| terms.iter().any(|t| bare(t) == bare(term)))
    }

    /// Models whose geometry has the moments that bend some springs; it uses up as many
    /// equations as told.
    fn weighed(
        &self,
        springs: &[usize],
        models: &[&[usize]],
        scale: f64,
        freedom: Option<f64>,
    ) -> Weighing {
        // What the state has is among them: rows are what is left without its terms.
        let held = (0..self.possible.len()).filter(|m| self.has(*m, &self.state.terms));
        let mut members: Vec<usize> = models.iter().copied().flatten().copied().collect();
        members.extend(held);
        members.sort_unstable();
        members.dedup();
        let possible: Vec<Possible> = members.iter().map(|m| self.possible[*m].clone()).collect();
        let own = |term: &Term<f64>| {
            springs.iter().any(|s| self.has(*s, std::slice::from_ref(&ModelTerm::Arm(*term))))
        };
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
            subsets.fit(&own, &|_| None).log_mass
        };
        Weighing { masses: models.iter().map(of).collect(), log_det: geometry.log_det(), freedom }
    }
}

/// A term without its coefficient.
fn bare(term: &ModelTerm) -> ModelTerm {
    let mut term = term.clone();
    *term.coefficient_mut() = 0.0;
    term
}
