//! A spring in every joint.

use truearm::effects::Effect;

use super::Family;

pub(super) const FAMILY: Family = Family {
    name: Effect::JointCompliance.name(),
    offers: |data| data.loaded().map(|()| data.one_a_joint(Effect::JointCompliance)),
    // A joint gives way to its load.
    plausible: 0.0..1e-1,
    several: false,
};
