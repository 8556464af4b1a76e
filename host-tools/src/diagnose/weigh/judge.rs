//! A search's result judged: on poses held out, in both halves, against rivals.

use rayon::prelude::*;
use truearm::effects::{Order, Term};

use super::doubts;
use super::halves::{self, Borne};
use super::nameless::Nameless;
use super::partial_fits::{Explained, FOLD, Part};
use super::possible::{NAMELESS, What, listed};
use super::row_parts::{Parts, joined};
use super::sheet::ByCurves;
use super::weighed::{Doubt, Named, Unnamed, Weighed};
use crate::diagnose::candidates::{Candidate, arm_terms};
use crate::diagnose::node::Node;
use crate::diagnose::policy::POLICY;
use crate::evidence::{self, Claim, Explanation, Gram, Subsets, explain};
use crate::observations::Residual;

/// The answer.
#[must_use]
pub fn answer(
    of: &Explained,
    best: Node,
    found: &Explanation,
    parts: &Parts,
    grams: &[Gram],
) -> Weighed {
    let entries: Vec<_> = of.possible.iter().map(|p| p.entry.clone()).collect();
    let nested = nested(of, &entries, parts, grams);
    let mut claims = found.posterior.claims();
    claims.retain(|_, probability| *probability >= POLICY.worth_a_word);
    let only: Vec<Claim> = claims.keys().copied().collect();
    let halves = halves::all(of, found.scale, parts, grams);
    let borne = halves::of_claims(of, &only, found, &halves);
    let geometry = joined(grams.iter(), of.sheet.size());
    let whole = of.part(geometry, found.scale);
    let rows = parts.rows.concat();
    let mut names = Vec::new();
    let mut nameless: Vec<Unnamed> = Vec::new();
    for (claimed, borne) in claims.into_iter().zip(borne) {
        let helps = borne.gain[0] + borne.gain[1] > 0.0;
        let Some(member) = member(of, found, claimed.0) else { continue };
        match &of.possible[member].what {
            // Smooth functions fit whatever a few rows say: what one half tells must help
            // to predict the other.
            What::Nameless(Nameless::Follows(_)) if !helps => {}
            What::Nameless(what) => {
                nameless.push(unnamed(of, found, &whole, claimed, (*what, member), borne.gain));
            }
            What::Effect(candidate) => {
                names.push((named(of, found, &rows, claimed, candidate, &borne), candidate));
            }
        }
    }
    let names = names.into_iter().map(|(named, candidate)| {
        let other = || doubts::of(of.q, &best, candidate, &nameless);
        Named { doubt: named.doubt.or_else(other), ..named }
    });
    let mut names: Vec<Named> = names.collect();
    names.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    Weighed {
        best,
        names,
        nameless,
        rivals: rivals(of, found),
        scale: found.scale,
        nested,
        refused: Vec::new(),
        surely_refused: Vec::new(),
        scattering: Vec::new(),
        moments: None,
        no_room: 0,
        curves: Vec::new(),
        by_curves: ByCurves::default(),
        stages: Vec::new(),
    }
}

/// A claim that a `member` without a name makes, with its coefficients fitted to all rows.
fn unnamed(
    of: &Explained,
    found: &Explanation,
    whole: &Part,
    (claim, probability): (Claim, f64),
    (what, member): (Nameless, usize),
    half_gain: [f64; 2],
) -> Unnamed {
    let own = found.best.members.iter().position(|m| *m == member);
    let coefficients = own.map(|k| of.block(whole, &found.best, k));
    let (instead, together) = instead(of, found, claim);
    Unnamed { what, probability, half_gain, instead, together, coefficients }
}

/// A claim of a name, and what halves of the rows and of the angles of its joint say against it.
fn named(
    of: &Explained,
    found: &Explanation,
    rows: &[usize],
    (claim, probability): (Claim, f64),
    candidate: &Candidate,
    borne: &Borne,
) -> Named {
    let doubt = match halves::of_levels(of, claim, found, rows) {
        _ if !borne.agree => Some(Doubt::Halves),
        Some(false) => Some(Doubt::Levels),
        _ => None,
    };
    let (name, joints) = (candidate.name(), candidate.joints());
    let orders = orders(of, found, claim);
    Named { name, joints, probability, orders, half_gain: borne.gain, doubt }
}

/// Of several ways to make a claim, the one of the most probable model.
fn member(of: &Explained, found: &Explanation, claim: Claim) -> Option<usize> {
    let holds = |m: &usize| Claim::from(&of.possible[*m].entry) == claim;
    let models = found.posterior.models.iter();
    models.flat_map(|(members, _)| members).copied().find(holds)
}

/// What stands where a claim does not, with the probability that it does; and that the claim
/// or the first of those without a name holds.
fn instead(of: &Explained, found: &Explanation, claim: Claim) -> (Vec<(What, f64)>, f64) {
    let mut rivals = found.posterior.alternatives(claim);
    rivals.retain(|(_, alone)| *alone >= POLICY.worth_a_word);
    let what = |other| member(of, found, other).map(|m| of.possible[m].what.clone());
    let whats = rivals.iter().filter_map(|(other, alone)| Some((what(*other)?, *alone))).collect();
    let nameless = rivals.iter().map(|r| r.0).filter(|other| other.name >= NAMELESS);
    let any: Vec<Claim> = nameless.take(1).chain([claim]).collect();
    (whats, found.posterior.probability_of_any(&any))
}

/// How probable each order is of a claim that candidates of some of several orders make: by all
/// models that have it. Lines are candidates of one order each, near others that are the same
/// line.
fn orders(of: &Explained, found: &Explanation, claim: Claim) -> Vec<(f64, f64)> {
    let own = |m: &usize| {
        let entry = &of.possible[*m].entry;
        Claim::from(entry) == claim && entry.part == 0
    };
    let candidates: Vec<usize> = (0..of.possible.len()).filter(own).collect();
    let waves = |m: usize| {
        let wave =
            |term: &Term<f64>| matches!(term.effect.order(), Order::Harmonic | Order::Cycles);
        let terms = of.possible[m].arm_terms().filter(wave);
        terms.map(|term| term.order).collect::<Vec<f64>>()
    };
    let mut all: Vec<f64> = candidates.iter().flat_map(|m| waves(*m)).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    // What all of them have is as probable as the claim, and says nothing of its size.
    let probability = |order: f64| {
        let with: Vec<usize> =
            candidates.iter().copied().filter(|m| waves(*m).contains(&order)).collect();
        let told = with.len() < candidates.len();
        told.then(|| (order, found.posterior.probability_of(&with)))
    };
    all.into_iter().filter_map(probability).collect()
}

/// Residuals of every row, predicted with all decided without its fold; the
/// orders that lines may have are those that all rows offer.
fn nested(
    of: &Explained,
    entries: &[evidence::Candidate],
    parts: &Parts,
    grams: &[Gram],
) -> Vec<Option<Residual>> {
    let predicted = of.q.folds.par_iter().enumerate().map(|(k, fold)| {
        let others = (0..grams.len()).filter(|p| parts.fold[*p] != k).map(|p| &grams[p]);
        let gram = joined(others, of.sheet.size());
        let own = explain(&gram, of.precision, entries, FOLD, None);
        // What has no name is not in a model either.
        let named = |m: &usize| matches!(of.possible[*m].what, What::Effect(_));
        let members: Vec<usize> = own.best.members.iter().copied().filter(named).collect();
        let (_, solution) = of.refitted(&of.part(gram, own.scale), &own, &members);
        of.sheet.left(&fold.held_out, &solution)
    });
    let mut nested = vec![None; of.q.problem.data.rows.len()];
    for (row, left) in predicted.collect::<Vec<_>>().into_iter().flatten() {
        nested[row] = Some(left);
    }
    nested
}

/// The best model's candidates; where it has more terms of the arm than are
/// asked for, those go that explain least a term.
pub fn within(of: &Explained, gram: &Gram, found: &Explanation) -> Vec<Candidate> {
    let mut members = found.best.members.clone();
    let terms = |members: &[usize]| {
        let added: Vec<Candidate> = listed(of.possible, members).into_iter().cloned().collect();
        arm_terms(&added)
    };
    if terms(&members) > of.q.most_terms {
        // As moments are: with a spring goes what they bend.
        let precision = of.sheet.holding_moments(of.precision);
        let projected = gram.project(&gram.geometry(&precision, found.scale));
        let entries = of.possible.iter().map(|p| p.entry.clone()).collect();
        let subsets = Subsets::new(projected, entries);
        while terms(&members) > of.q.most_terms {
            let with = subsets.fit(&members, &|_| None).log_mass;
            let cost = |m: &usize| {
                let less: Vec<usize> = members.iter().copied().filter(|o| o != m).collect();
                let own = (terms(&members) - terms(&less)) as f64;
                (with - subsets.fit(&less, &|_| None).log_mass) / own
            };
            let flashed = members.iter().filter(|m| terms(&[**m]) > 0);
            let rated = flashed.map(|m| (cost(m), *m));
            let Some((_, least)) = rated.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            members.retain(|m| *m != least);
        }
    }
    listed(of.possible, &members).into_iter().cloned().collect()
}

/// The most probable models with other claims, of some probability.
fn rivals(of: &Explained, found: &Explanation) -> Vec<(Vec<Candidate>, f64)> {
    let claims = |members: &[usize]| {
        let mut out: Vec<Claim> =
            members.iter().map(|m| Claim::from(&of.possible[*m].entry)).collect();
        out.sort();
        out.dedup();
        // Late or at once: the same name, but not the same explanation.
        let late = members.iter().any(|m| of.possible[*m].entry.common != 0);
        (out, late)
    };
    let best = found.posterior.models.first().map_or(1.0, |m| m.1);
    let mut seen = vec![claims(&found.best.members)];
    let mut out: Vec<(Vec<Candidate>, f64)> = Vec::new();
    for (members, probability) in &found.posterior.models {
        let own = claims(members);
        let odds = probability / best;
        if odds < POLICY.odds || seen.contains(&own) {
            continue;
        }
        let plain = own.0.iter().all(|claim| claim.name < NAMELESS);
        if plain {
            let added = listed(of.possible, members).into_iter().cloned().collect();
            out.push((added, odds));
        }
        seen.push(own);
    }
    out
}
