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

/// The next joints, counted from 0, whose scatter explains more than their effects alone, with
/// them or in their place: each beside those before it, so that one search follows and not one
/// a joint.
#[must_use]
pub fn next(q: &Question, found: &Searched) -> Vec<usize> {
    let known: Vec<usize> = found.weights.scattering.iter().map(|s| s.0).collect();
    let problem = found.bent.problem(q.problem);
    let compared = Compared { q, found, problem: &problem };
    let mut joints = known.clone();
    let mut members = asked(found);
    let mut plain = None;
    while let Some(more) = compared.next(&joints, &members, plain) {
        joints.push(more.joint);
        members = more.members;
        plain = Some(more.evidence);
    }
    joints.split_off(known.len())
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

/// A joint that scatters, and the better of the models with and without what fits it.
struct More {
    joint: usize,
    members: Vec<usize>,
    evidence: f64,
}

impl Compared<'_> {
    /// The joint whose scatter explains most beside these and a model of these members, if it
    /// explains enough more than they do alone (their evidence, where it is known).
    fn next(&self, joints: &[usize], members: &[usize], plain: Option<f64>) -> Option<More> {
        let after = |joints: &[usize]| weights::after(self.problem, &self.found.best, joints);
        let scattered = |joint: usize| {
            let fitted = |m: &usize| match &self.found.possible[*m].what {
                What::Effect(c) => fits(c, joint),
                What::Nameless(what) => what.joint() == Some(joint),
            };
            let bare: Vec<usize> = members.iter().copied().filter(|m| !fitted(m)).collect();
            if bare.len() == members.len() {
                return None;
            }
            let weights = after(&[joints, &[joint]].concat());
            weights.scattering.last().is_some_and(|s| s.1 > 0.0).then_some((joint, bare, weights))
        };
        let others = (0..self.problem.nominal.len()).into_par_iter();
        let asked: Vec<_> =
            others.filter(|joint| !joints.contains(joint)).filter_map(scattered).collect();
        if asked.is_empty() {
            return None;
        }
        let plain = plain.unwrap_or_else(|| self.evidence(&after(joints), [members])[0]);
        let more = |(joint, bare, weights): (usize, Vec<usize>, Weights)| {
            let [with, without] = self.evidence(&weights, [members, &bare]);
            let (members, evidence) =
                if without > with { (bare, without) } else { (members.to_vec(), with) };
            More { joint, members, evidence }
        };
        let rated: Vec<More> = asked.into_par_iter().map(more).collect();
        let best = rated.into_iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))?;
        (best.evidence - plain > -POLICY.odds.ln()).then_some(best)
    }

    /// Log evidence under such noise of models that are parts of the first one, up to a
    /// constant of the rows.
    fn evidence<const M: usize>(&self, weights: &Weights, models: [&[usize]; M]) -> [f64; M] {
        let Self { q, found, problem } = self;
        let (state, rows) = (&found.best.fit.fit.state, &found.best.fit.kept);
        let all = models[0];
        let possible: Vec<_> = all.iter().map(|m| found.possible[*m].clone()).collect();
        let sheet = Sheet::new(problem, state, &possible, weights, &found.curves).bending(
            found.bent.bending(state),
            rows,
            q.flags.lambda,
        );
        let precision = sheet.precision(q.flags.lambda);
        let gram = sheet.gram(rows);
        let entries: Vec<Candidate> = possible.iter().map(|p| p.entry.clone()).collect();
        let scattered = Scattered::of(problem, state, rows, &weights.scattering);
        // At the noise that is left beside the scatter.
        let of = |members: &[usize]| {
            let own: Vec<usize> = (0..all.len()).filter(|k| members.contains(&all[*k])).collect();
            let (mut scale, mut out) = (found.found.scale, f64::NEG_INFINITY);
            for _ in 0..ROUNDS {
                let geometry = gram.geometry(&precision, scale);
                let subsets = Subsets::new(gram.project(&geometry), entries.clone());
                let best = subsets.fit(&own, &|_| None);
                let poses = gram.poses() as f64;
                out = best.log_mass - poses * scale.ln() - 0.5 * geometry.log_det();
                scale = subsets.scale_of(&best);
            }
            out - 0.5 * scattered.log_det
        };
        models.map(of)
    }
}

/// Change of a variance, as a share, that is none.
const SETTLED: f64 = 0.05;

/// Rounds of evidence and scale.
const ROUNDS: usize = 3;
