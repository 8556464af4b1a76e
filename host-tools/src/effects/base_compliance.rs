//! A base that leans under the arm, about x and y.

use truearm::effects::Effect;

use super::{Family, Offer};

pub(super) const FAMILY: Family = Family {
    name: Effect::BaseCompliance.name(),
    offers: |data| {
        data.massive().map(|()| vec![Offer::of_arm(Effect::BaseCompliance, &[], &[0.0], 1)])
    },
    // The base gives way to its load.
    plausible: 0.0..1e-1,
    several: false,
};
