//! What scatters by itself: a joint, whose lines are then the best of thousands of orders and
//! noise the better explanation, or the instrument's line of sight.

use rayon::prelude::*;
use truearm::effects::Effect;

use super::likelihood::Likelihood;
use super::nameless;
use super::possible::{What, members_of};
use super::search_result::Searched;
use super::sheet::{Sheet, Weights};
use super::sights;
use super::start::Start;
use super::weights::Left;
use crate::diagnose::candidates;
use crate::diagnose::policy::POLICY;
use crate::diagnose::question::Question;
use crate::error::Result;
use crate::evidence::{Candidate, Subsets};
use crate::identify::{Problem, Scatterer};
use crate::model::ModelTerm;

/// Whether it is a function of the angle of such a joint or of where that is read: what a search
/// among many makes of its scatter.
#[must_use]
pub fn fits(candidate: &candidates::Candidate, source: Scatterer) -> bool {
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
    kind && source.joint().is_some_and(|joint| candidate.joints().last() == Some(&(joint + 1)))
}

/// What is next to be changed of what scatters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// This one does, too.
    Add(Scatterer),
    /// This one does not, beside those that were found after it.
    Drop(Scatterer),
}

impl Change {
    /// What is not asked again.
    #[must_use]
    pub fn dropped(self) -> Option<Scatterer> {
        match self {
            Self::Add(_) => None,
            Self::Drop(source) => Some(source),
        }
    }
}

/// That whose scatter explains most, beside what stands for it or in its place, and enough
/// more than nothing; or what no longer explains enough beside others. What was `dropped` is
/// not asked again.
#[must_use]
pub fn next(q: &Question, found: &Searched, dropped: &[Scatterer]) -> Option<Change> {
    let known: Vec<Scatterer> = found.weights.scattering.iter().map(|s| s.0).collect();
    let (problem, state) = (found.bent.problem(q.problem), &found.best.fit.fit.state);
    let nameless = found.nameless();
    // What has no name and is of no joint is set aside, or it is scatter.
    let others: Vec<_> = nameless.iter().filter(|held| held.0.joint().is_none()).cloned().collect();
    let bare = nameless::without(&problem, state, &nameless);
    let unknown = unasked(&problem, (&bare, found), &known, dropped);
    let compared = Compared {
        q,
        found,
        problem: &nameless::without(&problem, state, &others),
        left: Left::of(&bare, &found.best, &[&known[..], &unknown].concat()),
    };
    let members = asked(found);
    let plain = compared.noise(&known);
    let enough = -POLICY.odds.ln();
    let price = |source: Scatterer| sights::price(source, found.best.fit.kept.len());
    let scattered = |source: Scatterer| {
        let fitted = |m: &usize| match &found.possible[*m].what {
            What::Effect(c) => fits(c, source),
            What::Nameless(what) => what.joint().is_some() && what.joint() == source.joint(),
        };
        let bare: Vec<usize> = members.iter().copied().filter(|m| !fitted(m)).collect();
        let noise = compared.noise(&[&known[..], &[source]].concat());
        // Nothing that it has may be its scatter: what is left has to say so by itself.
        let alone =
            bare.len() == members.len() && noise.likelihood.whole < plain.likelihood.whole + enough;
        let ratio = noise.weights.scattering.last().map_or(0.0, |s| s.1);
        let denied = || compared.left.denied(&noise.weights.scattering) > enough;
        (ratio > 0.0 && !alone && !denied()).then_some((source, bare, noise))
    };
    let asked: Vec<_> = unknown.into_par_iter().filter_map(scattered).collect();
    if asked.is_empty() && known.is_empty() {
        return None;
    }
    let plain = compared.evidence(&plain, &[&members]);
    let without = known.par_iter().map(|source| {
        let others: Vec<Scatterer> = known.iter().copied().filter(|k| k != source).collect();
        let less = compared.evidence(&compared.noise(&others), &[&members]);
        (*source, plain - less - price(*source))
    });
    let least = without.collect::<Vec<_>>().into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((source, _)) = least.filter(|least| least.1 < enough) {
        return Some(Change::Drop(source));
    }
    let rated: Vec<(Scatterer, f64)> = asked
        .par_iter()
        .map(|(source, bare, noise)| {
            let more = compared.evidence(noise, &[&members, bare]);
            (*source, more - plain - price(*source))
        })
        .collect();
    let best = rated.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (best.1 > enough).then_some(Change::Add(best.0))
}

/// What is asked: every joint and a line of sight, of which there is one at most.
fn unasked(
    problem: &Problem,
    (bare, found): (&Problem, &Searched),
    known: &[Scatterer],
    dropped: &[Scatterer],
) -> Vec<Scatterer> {
    let asked: Vec<Scatterer> = [known, dropped].concat();
    let joints = (0..problem.nominal.len()).map(Scatterer::Joint);
    let mut out: Vec<Scatterer> = joints.filter(|joint| !asked.contains(joint)).collect();
    if asked.iter().all(|source| source.instrument().is_none()) {
        let fit = &found.best.fit;
        let (left, _) = Left::of(bare, &found.best, known).without(known);
        out.extend(sights::possible(problem, &fit.fit.state, &fit.kept, &left));
    }
    out
}

/// Where a search begins after this change. What fitted the scatter of a joint has to be found
/// again beside it: with it in, the scatter is taken for smaller than it is.
///
/// # Errors
/// When a fit does not converge.
pub fn after(q: &Question, found: &Searched, change: Change) -> Result<Start> {
    let mut start = found.again();
    match change {
        Change::Add(source) => {
            start.node.added.retain(|c| !fits(c, source));
            let joint = source.joint();
            start.nameless.retain(|held| joint.is_none() || held.0.joint() != joint);
            start.scattering.push((source, 0.0));
        }
        Change::Drop(source) => start.scattering.retain(|s| s.0 != source),
    }
    let added = start.node.added.clone();
    start.fit(q, added)?;
    Ok(start)
}

/// Whether what scatters, with its ratio of variance, is what it was a round ago: while it grows, what stood in its place is still taken for an effect.
#[must_use]
pub fn is_settled(before: &[(Scatterer, f64)], now: &[(Scatterer, f64)]) -> bool {
    before.len() == now.len()
        && before.iter().zip(now).all(|(a, b)| (a.1 - b.1).abs() <= SETTLED * a.1.max(b.1))
}

/// What the most probable model has: effects, and what has no name but a joint.
fn asked(found: &Searched) -> Vec<usize> {
    let asked = |m: &usize| match &found.possible[*m].what {
        What::Nameless(nameless) => nameless.joint().is_some(),
        What::Effect(_) => false,
    };
    let nameless = found.found.best.members.iter().copied().filter(asked);
    members_of(&found.possible, &found.best.added).into_iter().chain(nameless).collect()
}
/// A search's result under other noise.
struct Compared<'a> {
    q: &'a Question<'a>,
    found: &'a Searched,
    problem: &'a Problem<'a>,
    /// What it leaves without anything that has no name, and how all that may scatter moves it.
    left: Left<'a>,
}

/// Noise of a fit beside what scatters.
struct Noise {
    weights: Weights,
    likelihood: Likelihood,
}

impl Compared<'_> {
    /// That of these, as large as what is left says.
    fn noise(&self, sources: &[Scatterer]) -> Noise {
        let weights = self.left.weights(sources);
        let likelihood = self.left.likelihood(&weights);
        Noise { weights, likelihood }
    }

    /// Log evidence of the best of some models under such noise, up to a constant of the rows.
    fn evidence(&self, noise: &Noise, models: &[&[usize]]) -> f64 {
        let Self { q, found, problem, .. } = self;
        let Noise { weights, likelihood } = noise;
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
        // Formulas for normal noise do not know what tails cost.
        best + weights.beyond + likelihood.beside
    }
}

/// Change of a variance, as a share, that is none.
const SETTLED: f64 = 0.05;

/// Rounds of evidence and scale.
const ROUNDS: usize = 3;
