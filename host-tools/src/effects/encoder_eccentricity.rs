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

/// A disc that is off and oval, and one that is oval alone (or is read by two heads), are rarer
/// than one that is off. Over narrow angles of a joint nothing else tells them apart: with 1 and
/// 40 of 66 simulated oval discs 34 were said to be off as well (`docs/results.md`).
const BOTH: usize = 10;
const OVAL: usize = 20;

fn offers(data: &Data) -> Vec<Offer> {
    let joints = data.joints(EFFECT);
    let ways = [(&[1.0][..], 1), (&[1.0, 2.0], BOTH), (&[2.0], OVAL)];
    let of = |j: usize| {
        // Without masses a spring may be what it is taken for, and no disc that is off beside it.
        let sprung = data.assumed && data.conditions.is_loaded(j);
        let count = joints.len();
        let ways = ways.into_iter().filter(move |(orders, _)| !(sprung && *orders == [2.0]));
        ways.map(move |(orders, rarer)| Offer::of_arm(EFFECT, &[j], orders, rarer * count))
    };
    joints.iter().flat_map(|j| of(*j)).collect()
}
