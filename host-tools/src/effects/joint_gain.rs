//! The encoder's scale of every joint.

use truearm::effects::Effect;

use super::Family;

pub(super) const FAMILY: Family = Family {
    name: Effect::JointGain.name(),
    offers: |data| Ok(data.one_a_joint(Effect::JointGain)),
    plausible: -2e-2..2e-2,
    several: false,
};
