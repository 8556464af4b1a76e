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

fn offers(data: &Data) -> Vec<Offer> {
    let joints = data.joints(EFFECT);
    let both = |j: &usize| {
        [&[1.0][..], &[1.0, 2.0]].map(|orders| Offer::of_arm(EFFECT, &[*j], orders, joints.len()))
    };
    joints.iter().flat_map(both).collect()
}
