//! Which joints have an error curve, by the evidence.

use truearm::effects::Effect;

use super::Curve;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::weigh::lines::{self, Held};
use crate::diagnose::weigh::possible::{Possible, What, columns_of, columns_of_member, revolute};
use crate::diagnose::weigh::sheet::{Sheet, Weights};
use crate::effects::Offer;
use crate::evidence::drawn::{Drawn, Wave, drawn};
use crate::evidence::lines::LOWEST;
use crate::evidence::prior;
use crate::evidence::smooth::{self, Odds, Prior, Shape};
use crate::identify::{Problem, State};

/// Poses that an order needs.
const POSES_AN_ORDER: usize = 4;

/// What joints are off by beside what else was found.
#[derive(Debug, Default)]
pub struct Chosen {
    /// Joints with a curve.
    pub curves: Vec<Curve>,
    /// Lines that say as much as a curve would.
    pub lines: Vec<Held>,
    /// Joints whose lines are to be others.
    pub few: Vec<Few>,
}

/// Lines of a joint and what says as much in their place.
#[derive(Debug)]
pub struct Few {
    /// In the model.
    pub instead_of: Vec<Candidate>,
    /// Few lines of whole orders.
    pub lines: Vec<Held>,
}

impl Few {
    fn new(members: &[Possible], curve: &Curve, orders: &[usize]) -> Option<Self> {
        let is_high = |order: &f64| *order > LOWEST;
        let orders = orders.iter().map(|n| *n as f64).filter(is_high);
        let lines: Vec<Held> = orders.map(|order| (curve.joint, order)).collect();
        let instead_of: Vec<Candidate> = members
            .iter()
            .filter(|m| m.is_within(std::slice::from_ref(curve)))
            .filter_map(|m| match &m.what {
                What::Effect(candidate) => Some(candidate),
                What::Nameless(_) => None,
            })
            .filter(|c| !lines::of(std::slice::from_ref(*c)).is_empty())
            .cloned()
            .collect();
        let were = lines::of(&instead_of);
        let same = were.len() == lines.len() && lines.iter().all(|line| were.contains(line));
        (!same).then_some(Self { instead_of, lines })
    }

    /// Its lines, coefficients zero.
    pub fn candidates(&self) -> impl Iterator<Item = Candidate> {
        let offer = |(joint, order): &Held| {
            Offer::of_arm(Effect::JointPeriodicError, &[*joint], &[*order], 1)
        };
        self.lines.iter().map(offer).map(Candidate::from)
    }
}

/// Which joints have a curve, beside what else was found, and their priors; and which
/// lines of up to `highest` cycles a turn would do instead.
#[must_use]
pub fn chosen(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    members: &[Possible],
    weights: &Weights,
    (lambda, scale): (f64, f64),
    highest: f64,
) -> Chosen {
    let joints = revolute(problem);
    let most = problem.data.poses / POSES_AN_ORDER;
    let Some(length) = smooth::LENGTHS.into_iter().find(|l| smooth::orders(*l) <= most) else {
        return Chosen::default();
    };
    let size = smooth::SIZES[0];
    let all: Vec<Curve> =
        joints.iter().map(|joint| Curve { joint: *joint, prior: Prior { length, size } }).collect();
    let sheet = Sheet::new(problem, state, members, weights, &all).with_curves_apart();
    let gram = sheet.gram(rows);
    let projected = gram.project(&gram.geometry(&sheet.precision(lambda), scale));
    let line = |order: usize| line_odds(joints.len(), order, highest);
    let curve = prior::log_odds(joints.len(), smooth::PRIORS);
    let orders = smooth::orders(length);
    // All curves are chosen together, beside what else was found but for waves that draw one.
    let (mut out, mut few) = (Vec::new(), Vec::new());
    for (k, all) in all.iter().enumerate() {
        let own = waves(members, all);
        if own.len() < 2 {
            continue;
        }
        let place = (columns_of(members), orders);
        match drawn(&projected, place, k, &own, prior::log_odds(joints.len(), 1)) {
            Drawn::Waves => {}
            Drawn::Curve => out.extend(own.into_iter().flat_map(|wave| wave.columns)),
            Drawn::Few(orders) => few.extend(Few::new(members, all, &orders)),
        }
    }
    let beside = columns_of(members) - out.len();
    let projected = projected.without(&out);
    let shapes = |line: Option<&dyn Fn(usize) -> f64>| {
        let odds = Odds { curve, line };
        smooth::choose(&projected, beside, orders, &odds)
    };
    let smooth = joints.iter().zip(shapes(None)).filter_map(|(joint, shape)| match shape? {
        Shape::Curve(prior) => Some(Curve { joint: *joint, prior }),
        Shape::Line { .. } => None,
    });
    let curves: Vec<Curve> = smooth.collect();
    if curves.is_empty() {
        return Chosen { few, ..Chosen::default() };
    }
    let instead =
        joints.iter().zip(shapes(Some(&line))).filter_map(|(joint, shape)| match shape? {
            Shape::Line { order, .. } => Some((*joint, order as f64)),
            Shape::Curve(_) => None,
        });
    let lines = instead.filter(|(joint, _)| curves.iter().any(|c| c.joint == *joint)).collect();
    Chosen { curves, lines, few }
}

/// Members that a curve of their joint would take the place of.
fn waves(members: &[Possible], curve: &Curve) -> Vec<Wave> {
    let own = (0..members.len()).filter(|m| members[*m].is_within(std::slice::from_ref(curve)));
    let wave = |m: usize| Wave {
        columns: columns_of_member(members, m).collect(),
        log_odds: members[m].entry.log_odds,
    };
    own.map(wave).collect()
}

/// Of a line, or of an eccentricity, which has the lowest two orders.
fn line_odds(joints: usize, order: usize, highest: f64) -> f64 {
    let sizes = smooth::SIZES.len();
    match order as f64 > LOWEST {
        true => prior::line_log_odds(joints, 1, sizes * highest as usize, true),
        false => prior::log_odds(joints, 2 * sizes),
    }
}
