//! Which joints have an error curve, by the evidence.

use truearm::effects::Effect;

use crate::diagnose::candidates::Candidate;
use crate::diagnose::weigh::curve::Curve;
use crate::diagnose::weigh::lines::{self, Held};
use crate::diagnose::weigh::possible::{Possible, What, columns_of, columns_of_member, revolute};
use crate::diagnose::weigh::sheet::{Sheet, Weights};
use crate::effects::Offer;
use crate::evidence::drawn::{Drawn, Wave, drawn, few_instead};
use crate::evidence::lines::LOWEST;
use crate::evidence::prior;
use crate::evidence::smooth::{self, Prior};
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
/// lines would do instead.
#[must_use]
pub fn chosen(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    members: &[Possible],
    weights: &Weights,
    (lambda, scale): (f64, f64),
) -> Chosen {
    let joints = revolute(problem);
    let most = problem.data.poses / POSES_AN_ORDER;
    let Some(length) = smooth::LENGTHS.into_iter().find(|l| smooth::orders(*l) <= most) else {
        return Chosen::default();
    };
    let size = smooth::SIZES[0];
    let whole = |joint: &usize| Curve {
        joint: *joint,
        prior: Prior { length, size },
        few: f64::NEG_INFINITY,
    };
    let all: Vec<Curve> = joints.iter().map(whole).collect();
    let sheet = Sheet::new(problem, state, members, weights, &all).with_curves_apart();
    let gram = sheet.gram(rows);
    let projected = gram.project(&gram.geometry(&sheet.precision(lambda), scale));
    let function = prior::log_odds(joints.len(), 1);
    let orders = smooth::orders(length);
    // All curves are chosen together, beside what else was found but for waves that draw one.
    let (mut out, mut few) = (Vec::new(), Vec::new());
    for (k, all) in all.iter().enumerate() {
        let own = waves(members, all);
        if own.len() < 2 {
            continue;
        }
        let place = (columns_of(members), orders);
        match drawn(&projected, place, k, &own, function) {
            Drawn::Waves => {}
            Drawn::Curve => out.extend(own.into_iter().flat_map(|wave| wave.columns)),
            Drawn::Few(orders) => few.extend(Few::new(members, all, &orders)),
        }
    }
    let beside = columns_of(members) - out.len();
    let projected = projected.without(&out);
    let place = (beside, orders);
    let chosen = smooth::choose(&projected, place, prior::log_odds(joints.len(), smooth::PRIORS));
    let (mut curves, mut lines) = (Vec::new(), Vec::new());
    for (k, joint) in joints.iter().copied().enumerate() {
        let Some(prior) = chosen[k] else { continue };
        let (orders, few) = few_instead(&projected, place, &chosen, k, function);
        curves.push(Curve { joint, prior, few });
        if few > 0.0 {
            let orders = orders.into_iter().map(|n| n as f64).filter(|order| *order > LOWEST);
            lines.extend(orders.map(|order| (joint, order)));
        }
    }
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
