//! Many arms of one type: what they share, which of them differ, and how far the next
//! one is expected to be off in each parameter.

mod against;
mod learn;
mod step;
mod student;
#[cfg(test)]
mod tests;

use truearm::LinkParameter;

use against::Against;
pub use learn::Learned;
use learn::learn;

use crate::error::count as counted;
use crate::identify::certainty::error_bars::FACTOR;
use crate::identify::typical::of_type;
use crate::identify::{Identification, Unknown};
use crate::model::Robot;
use crate::tikhonov::Normal;
use step::{alone, noises};
use student::beyond;

/// Chance that a fleet in which no arm differs has one named, and that a type whose
/// drawing is right has a common correction named.
pub const LEVEL: f64 = 0.05;
/// Fewer arms name neither an arm that differs nor a correction that is common.
pub const FEWEST: usize = 3;
/// Noise is stated within a factor of two at best; rows that are farther off than this many
/// times the stated sigma in most arms do something that is not noise.
const FAR: f64 = 3.0;
/// Arms that may be told to differ, one in so many: more of them are the type.
const MOST_APART: usize = 3;

/// An arm as the fleet sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// What its measurements say of its links alone; corrections from nominal, in
    /// usual tolerances (1 mm, 1 mrad).
    links: Normal,
}

impl Arm {
    /// Of an identification in the prior scaling.
    #[must_use]
    pub fn of(found: &Identification) -> Self {
        let [units, from] = of_type(&found.model.robot);
        let per_unit = units.map(f64::recip);
        Self { links: found.links.recounted(&per_unit, &-from.component_mul(&per_unit)) }
    }
}

/// What stands out of an arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// The parameter farthest from the type, for what the type spreads: joint from 0.
    pub joint: usize,
    /// Which of the joint.
    pub parameter: LinkParameter,
    /// Its deviation from the mean of the type, m or rad.
    pub deviation: f64,
    /// The same over its standard deviation in arms of the type.
    pub sigmas: f64,
    /// Noise of its measurements over that of the other arms.
    pub noise: f64,
    /// Chance that any arm of a fleet of the type is as far off in any of this.
    pub chance: f64,
    /// Whether the type was learned without it.
    pub apart: bool,
}

/// What a fleet says of a parameter of the next arm; m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Joint, from 0.
    pub joint: usize,
    /// Which of it.
    pub parameter: LinkParameter,
    /// One standard deviation about the expected correction.
    pub tolerance: f64,
    /// 95 % interval of the spread of the arms.
    pub interval: [f64; 2],
    /// Tolerance of arms of which nothing is known.
    pub usual: f64,
    /// Mean correction, zero where none is common.
    pub expected: f64,
    /// Of a mean that is: the chance of one so far off in a type whose drawing is right.
    pub chance: Option<f64>,
    /// How many arms' worth the measurements say of it.
    pub determined: f64,
}

/// What a fleet says.
#[derive(Debug, Clone)]
pub struct Fleet {
    /// Of the type, from the arms that do not differ.
    pub learned: Learned,
    /// Parameters whose mean is not zero: where, and the chance of one so far off in a
    /// type whose drawing is right.
    pub common: Vec<(usize, f64)>,
    /// Of every arm, in their order.
    pub arms: Vec<Judgement>,
    /// Noise of the measurements of each over what was stated, whatever its corrections are.
    pub noises: Vec<f64>,
}

impl Fleet {
    /// Of arms of one type, one at least, with as many joints each.
    #[must_use]
    pub fn of(arms: &[Arm]) -> Self {
        let joints = arms.first().map_or(0, |arm| arm.links.unknowns() / 5);
        let lengths: Vec<bool> =
            (0..joints).flat_map(|_| LinkParameter::ALL.map(LinkParameter::is_length)).collect();
        let all: Vec<&Normal> = arms.iter().map(|arm| &arm.links).collect();
        let noises = noises(&all);
        let mut apart = vec![false; arms.len()];
        loop {
            let kept = all.iter().zip(&apart).filter(|(_, apart)| !**apart);
            let kept: Vec<&Normal> = kept.map(|(arm, _)| *arm).collect();
            let (learned, common) = learned(&kept, &lengths);
            let judged = judged(&all, (&noises, &apart), &learned, &common);
            let candidates = judged.iter().enumerate().filter(|(_, j)| !j.apart);
            let worst = candidates.min_by(|a, b| a.1.chance.total_cmp(&b.1.chance));
            let room = MOST_APART * (arms.len() - kept.len() + 1) <= arms.len();
            match worst.filter(|(_, j)| room && j.chance < LEVEL) {
                Some((k, _)) => apart[k] = true,
                None => {
                    let noises = alone(&all).into_iter().map(f64::sqrt).collect();
                    return Self { learned, common, arms: judged, noises };
                }
            }
        }
    }

    /// A remark where most arms do what geometry does not explain, or were all measured worse
    /// than stated.
    #[must_use]
    pub fn unexplained(&self) -> Option<String> {
        let all = self.noises.len();
        let noisy = self.noises.iter().filter(|noise| **noise >= FAR).count();
        (2 * noisy > all).then(|| {
            format!(
                "the rows of {noisy} of {} are {FAR} times as far off as their stated sigma or \
                 more: either the sigma is too small, or the arms do what geometry lacks, which \
                 `truearm diagnose` of one of them looks for; the tolerances learned hold what is \
                 missing as well",
                counted(all, "arm")
            )
        })
    }

    /// What is known of each parameter of the next arm, five a joint.
    #[must_use]
    pub fn priors(&self) -> Vec<Prior> {
        let (tolerance, freedom) = (self.learned.tolerance(), self.learned.freedom());
        let of = |k: usize| {
            let (joint, parameter) = (k / 5, LinkParameter::ALL[k % 5]);
            let usual = Unknown::Link(joint, parameter).tolerance();
            // The logarithm of a variance is known to the root of two over its freedom.
            let (spread, off) =
                (self.learned.variance[k].sqrt() * usual, FACTOR / (2.0 * freedom[k]).sqrt());
            let chance = self.common.iter().find(|(place, _)| *place == k);
            Prior {
                joint,
                parameter,
                tolerance: tolerance[k] * usual,
                interval: [spread * (-off).exp(), spread * off.exp()],
                usual,
                expected: self.learned.mean[k] * usual,
                chance: chance.map(|(_, chance)| *chance),
                determined: self.learned.determined[k],
            }
        };
        (0..tolerance.len()).map(of).collect()
    }

    /// The robot with what is known of its type.
    #[must_use]
    pub fn prior_of(&self, robot: &Robot) -> Robot {
        let mut robot = robot.clone();
        for prior in self.priors() {
            let (of, p) = (&mut robot.joints[prior.joint].prior, prior.parameter as usize);
            of.tolerance[p] = Some(prior.tolerance);
            of.expected[p] = prior.expected;
        }
        robot
    }
}

/// The type of some arms, means let free one after the other while one leans too far
/// from zero for chance.
fn learned(arms: &[&Normal], lengths: &[bool]) -> (Learned, Vec<(usize, f64)>) {
    let mut common: Vec<(usize, f64)> = Vec::new();
    loop {
        let free: Vec<usize> = common.iter().map(|(k, _)| *k).collect();
        let found = learn(arms, lengths, &free);
        if arms.len() < FEWEST {
            return (found, common);
        }
        let leaning = found.leaning(arms, &free);
        let asked = leaning.iter().flatten().count() as f64;
        let chances = leaning.iter().enumerate().filter_map(|(k, p)| Some((k, asked * (*p)?)));
        let next = chances.min_by(|a, b| a.1.total_cmp(&b.1));
        match next.filter(|(_, chance)| *chance < LEVEL) {
            Some(next) => common.push(next),
            None => return (found, common),
        }
    }
}

/// Every arm against the others.
fn judged(
    arms: &[&Normal],
    (noises, apart): (&[f64], &[bool]),
    learned: &Learned,
    common: &[(usize, f64)],
) -> Vec<Judgement> {
    let free: Vec<usize> = common.iter().map(|(k, _)| *k).collect();
    let mut members = 0;
    let places = apart.iter().map(|apart| {
        members += usize::from(!apart);
        (!apart).then_some(members.wrapping_sub(1))
    });
    let places: Vec<Option<usize>> = places.collect();
    let of = |(i, place): (usize, &Option<usize>)| {
        let against = learned.against((arms[i], noises[i]), *place, &free);
        let (k, sigmas, alone) = farthest(&against);
        let (noise, noisy) = noise(noises, apart, i);
        // Two questions of every arm.
        let chance = 2.0 * arms.len() as f64 * alone.min(noisy);
        let (joint, parameter) = (k / 5, LinkParameter::ALL[k % 5]);
        let usual = Unknown::Link(joint, parameter).tolerance();
        Judgement {
            joint,
            parameter,
            deviation: against.deviation[k] * usual,
            sigmas,
            noise,
            chance: chance.min(1.0),
            apart: place.is_none(),
        }
    };
    places.iter().enumerate().map(of).collect()
}

/// The parameter that stands out most, by how many standard deviations, and the chance
/// of any so far off.
fn farthest(against: &Against) -> (usize, f64, f64) {
    let asked = against.sigma.iter().filter(|sigma| **sigma > 0.0).count() as f64;
    let of = |k: usize| {
        let sigmas = against.deviation[k] / against.sigma[k];
        (k, sigmas, (asked * beyond(sigmas, against.freedom[k] as usize)).min(1.0))
    };
    let judged = (0..against.sigma.len()).filter(|k| against.sigma[*k] > 0.0).map(of);
    judged.min_by(|a, b| a.2.total_cmp(&b.2)).unwrap_or((0, 0.0, 1.0))
}

/// Scatter of the noise of arms of one session that means nothing, as a share.
const SAME: f64 = 0.05;

/// Noise of an arm's measurements over that of the others of the type, and the chance
/// of one so large.
fn noise(noises: &[f64], apart: &[bool], arm: usize) -> (f64, f64) {
    let others = noises.iter().zip(apart).enumerate();
    let others = others.filter(|(i, (_, apart))| *i != arm && !**apart);
    let others: Vec<f64> = others.map(|(_, (noise, _))| noise.ln() / 2.0).collect();
    let count = others.len() as f64;
    let mean = others.iter().sum::<f64>() / count.max(1.0);
    let off = noises[arm].ln() / 2.0 - mean;
    if others.len() < 2 || off <= 0.0 {
        return (off.exp(), 1.0);
    }
    let square = others.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let sigma = ((square + SAME * SAME) * (1.0 + 1.0 / count)).sqrt();
    (off.exp(), beyond(off / sigma, others.len() - 1) / 2.0)
}
