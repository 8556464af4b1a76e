//! A spring in every joint that is not linear, beside its compliance.

use truearm::effects::Effect;

use super::Family;

pub(super) const FAMILY: Family = Family {
    name: Effect::JointStiffening.name(),
    offers: |data| data.loaded().map(|()| data.one_a_joint(Effect::JointStiffening)),
    // Named alone it gives way to its load; beside a compliance, a spring that
    // stiffens takes some of it back: 600 urad at 10 N m is 6e-6.
    plausible: -1e-5..1e-5,
    several: false,
};
