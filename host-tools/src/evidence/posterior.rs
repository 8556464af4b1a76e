//! What the models together say: probability of a name at a place, and who
//! shares it.

use std::collections::{BTreeMap, BTreeSet};

use super::candidate::Candidate;
use super::search::{Masses, WINDOW};

/// A name at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Claim {
    /// The caller's number of the name.
    pub name: usize,
    /// The caller's number of the place.
    pub place: usize,
}

impl From<&Candidate> for Claim {
    fn from(candidate: &Candidate) -> Self {
        Self { name: candidate.name, place: candidate.place }
    }
}

/// Models that hold the probability, most probable first.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Members and probability of each.
    pub models: Vec<(Vec<usize>, f64)>,
    claims: Vec<BTreeSet<Claim>>,
}

/// An alternative is worth a word when it holds this much of the probability.
const WORTH_A_WORD: f64 = 0.02;
/// ... and is so much more probable without the claim than with it.
const RIVAL: f64 = 2.0;

impl Posterior {
    /// Of all models within 25 nats of the best.
    #[must_use]
    pub fn new(masses: &Masses, candidates: &[Candidate]) -> Self {
        let best = masses.values().copied().fold(f64::NEG_INFINITY, f64::max);
        let near = masses.iter().filter(|(_, mass)| **mass > best - WINDOW);
        let mut models: Vec<(Vec<usize>, f64)> =
            near.map(|(members, mass)| (members.clone(), (mass - best).exp())).collect();
        models.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        let all: f64 = models.iter().rev().map(|(_, p)| p).sum();
        for (_, p) in &mut models {
            *p /= all;
        }
        let claims = models
            .iter()
            .map(|(members, _)| members.iter().map(|g| (&candidates[*g]).into()).collect())
            .collect();
        Self { models, claims }
    }

    /// Probability of each claim that any model makes.
    #[must_use]
    pub fn claims(&self) -> BTreeMap<Claim, f64> {
        let mut out = BTreeMap::new();
        for (claims, (_, p)) in self.claims.iter().zip(&self.models).rev() {
            for claim in claims {
                *out.entry(*claim).or_default() += p;
            }
        }
        out
    }

    /// Probability that the models hold a claim.
    #[must_use]
    pub fn probability(&self, claim: Claim) -> f64 {
        self.mass(|claims, _| claims.contains(&claim))
    }

    /// Probability that the models hold any of some claims.
    #[must_use]
    pub fn probability_of_any(&self, any: &[Claim]) -> f64 {
        self.mass(|claims, _| any.iter().any(|claim| claims.contains(claim)))
    }

    /// Probability that any of some candidates is in the model: of one line,
    /// of one variant.
    #[must_use]
    pub fn probability_of(&self, candidates: &[usize]) -> f64 {
        self.mass(|_, members| candidates.iter().any(|g| members.contains(g)))
    }

    /// Claims that stand where this one does not: each with the probability
    /// that it holds and the claim does not, largest first.
    #[must_use]
    pub fn alternatives(&self, claim: Claim) -> Vec<(Claim, f64)> {
        let with = self.probability(claim);
        let without = 1.0 - with;
        let each = self.claims().into_keys().filter(|other| *other != claim).map(|other| {
            let alone = self.mass(|c, _| c.contains(&other) && !c.contains(&claim));
            let both = self.mass(|c, _| c.contains(&other) && c.contains(&claim));
            (other, alone, both)
        });
        let rivals = each.filter(|(_, alone, both)| {
            *alone > WORTH_A_WORD && alone * with > RIVAL * both * without
        });
        let mut out: Vec<(Claim, f64)> = rivals.map(|(other, alone, _)| (other, alone)).collect();
        out.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        out
    }

    fn mass(&self, holds: impl Fn(&BTreeSet<Claim>, &[usize]) -> bool) -> f64 {
        let pairs = self.claims.iter().zip(&self.models).rev();
        pairs.filter(|(claims, (members, _))| holds(claims, members)).map(|(_, (_, p))| p).sum()
    }
}
