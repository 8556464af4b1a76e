//! Whether a claim survives in the data's other half: coefficients of both
//! halves agree, and what one half says helps to predict the other.

use rayon::prelude::*;
use truearm::effects::{Order, Term};

use super::doubts;
use super::partial_fits::{Explained, Part};
use super::possible::Possible;
use super::row_parts::{Parts, joined};
use super::sheet::Solution;
use crate::diagnose::chi_square::chi_square;
use crate::diagnose::policy::POLICY;
use crate::evidence::{Claim, Coefficient, Explanation, Gram};

/// Half of the rows.
pub struct Half {
    /// Their sums.
    pub part: Part,
    /// The same with moments of the links as stated, where they are unknown.
    pub stated: Option<Part>,
    /// Which they are.
    pub rows: Vec<usize>,
}

/// Both halves at random, and both in time.
#[must_use]
pub fn all(of: &Explained, scale: f64, parts: &Parts, grams: &[Gram]) -> [[Half; 2]; 2] {
    let held = of.sheet.holding_moments(of.precision);
    let stated = Explained { precision: &held, ..*of };
    let unknown = held != *of.precision;
    let half = |kind: usize, h: usize| {
        let rows = parts.rows_of_half(kind, h);
        let unknowns = grams.first().map_or([0; 2], |g| [g.unknowns(), g.columns()]);
        let sum = joined(parts.of_half(kind, h).map(|p| &grams[p]), unknowns);
        let stated = unknown.then(|| stated.part(sum.clone(), scale));
        Half { part: of.part(sum, scale), stated, rows }
    };
    [0, 1].map(|kind| [0, 1].map(|h| half(kind, h)))
}

/// A claim, and whether halves bear it out.
pub struct Borne {
    /// Fall of the error of each half by the claim fitted to the other one, at random halves.
    pub gain: [f64; 2],
    /// Halves at random and in time agree.
    pub agree: bool,
}

/// The most probable model with a claim, and without it.
struct Judged {
    members: Vec<usize>,
    without: Vec<usize>,
    /// What a spring bends the moments would bend in its place.
    bends: bool,
    of_time: bool,
}

impl Judged {
    fn new(of: &Explained, claim: Claim, found: &Explanation) -> Option<Self> {
        let holds = |m: &usize| Claim::from(&of.possible[*m].entry) == claim;
        let mut models = found.posterior.models.iter();
        let (members, _) = models.find(|(members, _)| members.iter().any(holds))?;
        let any = |is: &dyn Fn(&Possible) -> bool| {
            of.possible.iter().zip(0..).any(|(p, m)| holds(&m) && is(p))
        };
        Some(Self {
            members: members.clone(),
            without: members.iter().copied().filter(|m| !holds(m)).collect(),
            bends: any(&Possible::is_spring),
            of_time: any(&Possible::is_of_time),
        })
    }

    /// Coefficients of the claim fitted to a half, and solutions with it and without.
    fn fitted(
        &self,
        of: &Explained,
        half: &Half,
        found: &Explanation,
    ) -> (Vec<Coefficient>, [Solution; 2]) {
        let (own, with) = of.refitted(&half.part, found, &self.members);
        let held = |m: &usize| !self.without.contains(m);
        let own = self.members.iter().zip(own).filter(|(m, _)| held(m)).flat_map(|(_, c)| c);
        let judged = half.stated.as_ref().filter(|_| self.bends);
        let with = judged.map_or(with, |part| of.refitted(part, found, &self.members).1);
        let part = judged.unwrap_or(&half.part);
        (own.collect(), [with, of.refitted(part, found, &self.without).1])
    }
}

/// Whether halves bear claims out.
#[must_use]
pub fn of_claims(
    of: &Explained,
    claims: &[Claim],
    found: &Explanation,
    halves: &[[Half; 2]; 2],
) -> Vec<Borne> {
    let apart = halves.iter().flatten().all(|half| !half.rows.is_empty());
    let judged = claims.iter().map(|claim| Judged::new(of, *claim, found).filter(|_| apart));
    let judged: Vec<Option<Judged>> = judged.collect();
    let bare = |judged: &Option<Judged>| Borne { gain: [0.0; 2], agree: judged.is_some() };
    let mut out: Vec<Borne> = judged.iter().map(bare).collect();
    for (kind, halves) in halves.iter().enumerate() {
        let [first, second] = [0, 1].map(|h| {
            let fit = |judged: &Judged| judged.fitted(of, &halves[h], found);
            let fits: Vec<_> = judged.par_iter().flatten().map(fit).collect();
            let (own, solutions): (Vec<_>, Vec<[Solution; 2]>) = fits.into_iter().unzip();
            let squares = of.sheet.misfits(&halves[1 - h].rows, &solutions.concat());
            own.into_iter().zip(squares.chunks_exact(2).map(gain).collect::<Vec<_>>())
        });
        let known = out.iter_mut().zip(&judged).filter_map(|(b, j)| Some((b, j.as_ref()?)));
        for ((borne, judged), (first, second)) in known.zip(first.zip(second)) {
            // How a base moves with time is another thing at the begin of a session than
            // at its end, unless the course is known exactly.
            let in_time = kind == 1 && judged.of_time;
            borne.agree &= in_time || agree(&first.0, &second.0, POLICY.halves_apart[kind]);
            // A series or a temperature may be in one half of the time only.
            if kind == 0 {
                borne.gain = [first.1, second.1];
                borne.agree &= borne.gain.iter().sum::<f64>() > 0.0;
            }
        }
    }
    out
}

/// Whether half of the angles at which a joint stood bears a claim out that goes with its angle
/// against the other half; `None` where it stood at many, or the claim is none such. Halves of
/// the poses both have all of few angles, where any function fits.
#[must_use]
pub fn of_levels(
    of: &Explained,
    claim: Claim,
    found: &Explanation,
    rows: &[usize],
) -> Option<bool> {
    let judged = Judged::new(of, claim, found)?;
    let own = judged.members.iter().filter(|m| !judged.without.contains(m));
    let terms: Vec<Term<f64>> = own.flat_map(|m| of.possible[*m].arm_terms()).collect();
    let wave = |term: &Term<f64>| matches!(term.effect.order(), Order::Harmonic | Order::Cycles);
    let order = |term: &Term<f64>| wave(term).then_some(term.order);
    let highest = terms.iter().filter_map(order).reduce(f64::max)?;
    let joint = usize::from(terms.first()?.joint);
    let data = &of.q.problem.data.rows;
    let angles: Vec<f64> = rows.iter().map(|r| data[*r].q[joint]).collect();
    let poses: Vec<usize> = rows.iter().map(|r| data[*r].pose).collect();
    let half = doubts::folds_of_levels(&angles, &poses, highest, 2)?;
    let half = |h: usize| {
        let rows = rows.iter().zip(&half).filter(|(_, own)| **own == h).map(|(row, _)| *row);
        let rows: Vec<usize> = rows.collect();
        Half { part: of.part(of.sheet.gram(&rows), found.scale), stated: None, rows }
    };
    let halves = [half(0), half(1)];
    let fits = halves.each_ref().map(|half| judged.fitted(of, half, found));
    let gain = |h: usize| gain(&of.sheet.misfits(&halves[1 - h].rows, &fits[h].1));
    let agree = agree(&fits[0].0, &fits[1].0, POLICY.halves_apart[0]);
    Some(agree && gain(0) + gain(1) > 0.0)
}

/// Fall of an error, of mean squares with something and without it.
fn gain(pair: &[f64]) -> f64 {
    let [with, without] = [pair[0], pair[1]].map(f64::sqrt);
    1.0 - with / without.max(f64::MIN_POSITIVE)
}

/// Whether coefficients of two halves agree.
fn agree(first: &[Coefficient], second: &[Coefficient], near: f64) -> bool {
    let pairs = || first.iter().zip(second);
    let variance = |a: &Coefficient, b: &Coefficient| {
        (a.sigma.powi(2) + b.sigma.powi(2)).max(f64::MIN_POSITIVE)
    };
    let apart: f64 = pairs().map(|(a, b)| (a.value - b.value).powi(2) / variance(a, b)).sum();
    // In one half of the time other poses were measured, at other loads and temperatures
    // that a sigma does not know of; at random, a sigma of a hundredth of the effect does
    // not know what is left of others: what is small beside the effect is no disagreement.
    let middle = |a: &Coefficient, b: &Coefficient| (a.value + b.value) / 2.0;
    let size: f64 = pairs().map(|(a, b)| middle(a, b).powi(2) / variance(a, b)).sum();
    chi_square(apart, first.len()) > POLICY.halves_disagree || apart < near.powi(2) * size
}
