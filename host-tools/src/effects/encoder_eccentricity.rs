//! An eccentric disc once a turn; two reading heads or an oval disc twice.

use truearm::effects::Effect;

use super::{Data, Family, Offer};

const EFFECT: Effect = Effect::EncoderEccentricity;

pub(super) const FAMILY: Family = Family {
    name: EFFECT.name(),
    offers: |data| Ok(offers(data)),
    // A disc off by more than a third of a degree does not count.
    plausible: -6e-3..6e-3,
    several: false,
};

/// An oval disc alone, or two heads that read a disc that is off and oval, is rarer than a disc
/// that is off, and at narrow angles of a joint nothing else tells them apart. At 10 three sets
/// of another maker had an oval one in place of one that is off, at 40 two (`docs/results.md`).
const TWICE_ALONE: usize = 40;

fn offers(data: &Data) -> Vec<Offer> {
    let joints = data.joints(EFFECT);
    let ways = [(&[1.0][..], 1), (&[1.0, 2.0], 1), (&[2.0], TWICE_ALONE)];
    let of = |j: usize| {
        // Without masses a spring may be what it is taken for, and no disc that is off beside it.
        let sprung = data.assumed && data.conditions.is_loaded(j);
        let count = joints.len();
        let ways = ways.into_iter().filter(move |(orders, _)| !(sprung && *orders == [2.0]));
        ways.map(move |(orders, rarer)| Offer::of_arm(EFFECT, &[j], orders, rarer * count))
    };
    joints.iter().flat_map(|j| of(*j)).collect()
}
