//! Every joint with every other.

use truearm::effects::Effect;

use super::{Data, Family, Offer};

const EFFECT: Effect = Effect::JointCoupling;

pub(super) const FAMILY: Family = Family {
    name: EFFECT.name(),
    offers: |data| Ok(offers(data)),
    // What a controller takes: gears of a wrist that nobody compensates couple by such shares.
    plausible: -5e-2..5e-2,
    several: false,
};

fn offers(data: &Data) -> Vec<Offer> {
    let joints = data.joints(EFFECT);
    let pairs = joints.len() * joints.len().saturating_sub(1);
    let of = |target: &usize| {
        let sources = joints.iter().filter(|source| *source != target);
        sources
            .map(|source| Offer::of_arm(EFFECT, &[*source, *target], &[0.0], pairs))
            .collect::<Vec<_>>()
    };
    joints.iter().flat_map(of).collect()
}
