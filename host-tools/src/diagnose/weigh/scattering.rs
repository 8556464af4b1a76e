//! A joint that scatters by itself: its lines are then the best of thousands of orders, and
//! noise the better explanation.

use rayon::prelude::*;
use truearm::effects::Effect;

use super::nameless::Nameless;
use super::possible::What;
use super::search_result::Searched;
use super::sheet::{Scattered, Sheet, Weights};
use super::{members_of, weights};
use crate::diagnose::candidates;
use crate::diagnose::policy::POLICY;
use crate::diagnose::question::Question;
use crate::evidence::{Candidate, Subsets};
use crate::identify::Problem;
use crate::model::ModelTerm;

/// Whether it is a function of the joint's angle (counted from 0) or of where that is read:
/// what a search among many makes of its scatter.
#[must_use]
pub fn fits(candidate: &candidates::Candidate, joint: usize) -> bool {
    use Effect::{
        EncoderEccentricity, GearTransmissionError, JointCoupling, JointGain, JointPeriodicError,
    };
    let kind = candidate.terms.first().is_some_and(|term| match term {
        ModelTerm::Arm(own) => matches!(
            own.effect,
            JointPeriodicError
                | EncoderEccentricity
                | GearTransmissionError
                | JointGain
                | JointCoupling
        ),
        ModelTerm::Lag { .. } => true,
        ModelTerm::Drift { .. } | ModelTerm::Remount { .. } => false,
    });
    kind && candidate.joints().last() == Some(&(joint + 1))
}

/// The next joint, counted from 0, whose scatter explains more than its effects alone, with
/// them or in their place.
#[must_use]
pub fn next(q: &Question, found: &Searched) -> Option<usize> {
    let known: Vec<usize> = found.weights.scattering.iter().map(|s| s.0).collect();
    let problem = found.bent.problem(q.problem);
    let members = asked(found);
    let compared = Compared { q, found, problem: &problem };
    let plain = weights::after(&problem, &found.best, &known);
    let scattered = |joint: usize| {
        let fitted = |m: &usize| match &found.possible[*m].what {
            What::Effect(c) => fits(c, joint),
            What::Nameless(what) => what.joint() == Some(joint),
        };
        let bare: Vec<usize> = members.iter().copied().filter(|m| !fitted(m)).collect();
        if bare.len() == members.len() {
            return None;
        }
        let with = [&known[..], &[joint]].concat();
        let weights = weights::after(&problem, &found.best, &with);
        weights.scattering.last().is_some_and(|s| s.1 > 0.0).then_some((joint, bare, weights))
    };
    let joints = (0..problem.nominal.len()).into_par_iter().filter(|joint| !known.contains(joint));
    let asked: Vec<_> = joints.filter_map(scattered).collect();
    if asked.is_empty() {
        return None;
    }
    let plain = compared.evidence(&plain, &[&members]);
    let rated: Vec<(usize, f64)> = asked
        .par_iter()
        .map(|(joint, bare, weights)| {
            (*joint, compared.evidence(weights, &[&members, bare]) - plain)
        })
        .collect();
    let best = rated.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (best.1 > -POLICY.odds.ln()).then_some(best.0)
}

/// Whether what joints scatter, (joint, ratio of variance), is what it was a round ago: while
/// it grows, what stood in its place is still taken for an effect.
#[must_use]
pub fn is_settled(before: &[(usize, f64)], now: &[(usize, f64)]) -> bool {
    before.len() == now.len()
        && before.iter().zip(now).all(|(a, b)| (a.1 - b.1).abs() <= SETTLED * a.1.max(b.1))
}

/// What the most probable model has: effects, and joints that are off as something goes.
fn asked(found: &Searched) -> Vec<usize> {
    let follows = |m: &usize| match &found.possible[*m].what {
        What::Nameless(Nameless::Follows(follows)) => follows.part.joint().is_some(),
        _ => false,
    };
    let nameless = found.found.best.members.iter().copied().filter(follows);
    members_of(&found.possible, &found.best).into_iter().chain(nameless).collect()
}

/// A search's result under other noise.
struct Compared<'a> {
    q: &'a Question<'a>,
    found: &'a Searched,
    problem: &'a Problem<'a>,
}

impl Compared<'_> {
    /// Log evidence of the best of some models under such noise, up to a constant of the rows.
    fn evidence(&self, weights: &Weights, models: &[&[usize]]) -> f64 {
        let Self { q, found, problem } = self;
        let (state, rows) = (&found.best.fit.fit.state, &found.best.fit.kept);
        let all = asked(found);
        let possible: Vec<_> = all.iter().map(|m| found.possible[*m].clone()).collect();
        let sheet = Sheet::new(problem, state, &possible, weights, &found.curves).bending(
            found.bent.bending(state),
            rows,
            q.flags.lambda,
        );
        let precision = sheet.precision(q.flags.lambda);
        let gram = sheet.gram(rows);
        let entries: Vec<Candidate> = possible.iter().map(|p| p.entry.clone()).collect();
        // At the noise that is left beside the scatter.
        let of = |members: &&[usize]| {
            let own: Vec<usize> = (0..all.len()).filter(|k| members.contains(&all[*k])).collect();
            let mut scale = found.found.scale;
            let mut out = f64::NEG_INFINITY;
            for _ in 0..ROUNDS {
                let geometry = gram.geometry(&precision, scale);
                let subsets = Subsets::new(gram.project(&geometry), entries.clone());
                let best = subsets.fit(&own, &|_| None);
                let poses = gram.poses() as f64;
                out = best.log_mass - poses * scale.ln() - 0.5 * geometry.log_det();
                scale = subsets.scale_of(&best);
            }
            out
        };
        let best = models.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        best - 0.5 * Scattered::of(problem, state, rows, &weights.scattering).log_det
    }
}

/// Change of a variance, as a share, that is none.
const SETTLED: f64 = 0.05;

/// Rounds of evidence and scale.
const ROUNDS: usize = 3;
