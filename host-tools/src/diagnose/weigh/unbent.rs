//! What moments of links do, they do to springs: a model without a spring has none of it.
//!
//! Moments are unknowns of geometry while a model with springs is linearised, and all models
//! are weighed with the same geometry. So one with an eccentricity in a spring's place would
//! have what the moments do to that spring besides, and explain as much.

use std::collections::BTreeMap;

use nalgebra::DVector;
use rayon::prelude::*;
use truearm::effects::Term;

use super::curve::Curve;
use super::possible::{Possible, What, columns_of_member};
use super::sheet::{Sheet, Weights};
use crate::diagnose::bending::Bending;
use crate::evidence::{Candidate, Explanation, Geometry, Gram, Noise, Projected, Subsets};
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
    let models: Vec<&[usize]> = by_springs.values().flatten().copied().collect();
    let members = at.members(&models);
    let possible: Vec<Possible> = members.iter().map(|m| at.possible[*m].clone()).collect();
    let whole = at.sheet(&possible, Some(bending.clone()));
    let columns: Vec<usize> =
        members.iter().flat_map(|m| columns_of_member(at.possible, *m)).collect();
    let asked = Asked { at, members, possible: &possible, columns, whole, scale: found.scale };
    let all = asked.with(gram, precision);
    let mut changes = Changes::new();
    // What was too improbable to be weighed again loses what the best of its springs does.
    let mut of_others: BTreeMap<Vec<usize>, f64> = BTreeMap::new();
    for (own, models) in &by_springs {
        let less = asked.only(own, (gram, &all));
        // Fewer unknowns: the prior's determinant of a moment is 1.
        let fewer = 0.5 * (all.geometry.log_det() - less.geometry.log_det());
        let change = |model: &&[usize]| {
            let [with, without] = [&all, &less].map(|of| asked.log_mass(of, model));
            (model.to_vec(), (without - with + fewer).min(0.0))
        };
        let each: Vec<_> = models.par_iter().map(change).collect();
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

impl At<'_> {
    /// Whether a candidate has any of these terms, whatever their coefficients.
    fn has(&self, candidate: usize, terms: &[ModelTerm]) -> bool {
        let What::Effect(own) = &self.possible[candidate].what else { return false };
        own.terms.iter().any(|term| terms.iter().any(|t| bare(t) == bare(term)))
    }

    /// What models have, and the state: rows are what is left without its terms.
    fn members(&self, models: &[&[usize]]) -> Vec<usize> {
        let held = (0..self.possible.len()).filter(|m| self.has(*m, &self.state.terms));
        let mut members: Vec<usize> = models.iter().copied().flatten().copied().collect();
        members.extend(held);
        members.sort_unstable();
        members.dedup();
        members
    }

    fn sheet<'s>(&'s self, possible: &'s [Possible], bending: Option<Bending>) -> Sheet<'s> {
        Sheet::new(self.problem, self.state, possible, self.weights, self.curves).bending(
            bending,
            self.rows,
            self.lambda,
        )
    }
}

/// Some of the candidates, weighed at a noise scale.
struct Asked<'s> {
    at: &'s At<'s>,
    members: Vec<usize>,
    possible: &'s [Possible],
    /// Where their columns stand among those of all candidates.
    columns: Vec<usize>,
    /// With what moments do to all springs of the state.
    whole: Sheet<'s>,
    scale: f64,
}

/// They under a geometry.
struct Weighing {
    geometry: Geometry,
    noise: Noise,
    subsets: Subsets,
}

impl Asked<'_> {
    fn weighing(&self, projected: Projected, (geometry, noise): (Geometry, Noise)) -> Weighing {
        let entries = self.possible.iter().map(|p| p.entry.clone()).collect();
        Weighing { geometry, noise, subsets: Subsets::new(projected, entries) }
    }

    /// With what moments do to all springs of the state, as they are in the sums.
    fn with(&self, gram: &Gram, precision: &DVector<f64>) -> Weighing {
        let geometry = gram.geometry(precision, self.scale);
        let noise = gram.noise(&geometry);
        let projected = gram.project_some((&geometry, noise), &self.columns);
        self.weighing(projected, (geometry, noise))
    }

    /// With what they do to some springs; the noise is told from as many equations.
    fn only(&self, springs: &[usize], (gram, all): (&Gram, &Weighing)) -> Weighing {
        let at = self.at;
        let own = |term: &Term<f64>| {
            springs.iter().any(|s| at.has(*s, std::slice::from_ref(&ModelTerm::Arm(*term))))
        };
        let own = at.bending.and_then(|bending| bending.only(&own));
        let less = at.sheet(self.possible, own);
        let sums = self.whole.exchanged(&less, at.rows, gram, &self.columns);
        let geometry = sums.geometry(&less.precision(at.lambda), self.scale);
        let own: Vec<usize> = (0..sums.columns()).collect();
        self.weighing(sums.project_some((&geometry, all.noise), &own), (geometry, all.noise))
    }

    fn log_mass(&self, of: &Weighing, model: &[usize]) -> f64 {
        let own: Vec<usize> =
            model.iter().filter_map(|m| self.members.binary_search(m).ok()).collect();
        of.subsets.fit(&own, &|_| None).log_mass
    }
}

/// A term without its coefficient.
fn bare(term: &ModelTerm) -> ModelTerm {
    let mut term = term.clone();
    *term.coefficient_mut() = 0.0;
    term
}
