//! A spring in every joint that is not linear, beside its compliance.

use truearm::effects::Effect;

use super::Family;

pub(super) const FAMILY: Family = Family {
    name: Effect::JointStiffening.name(),
    offers: |data| data.loaded().map(|()| data.one_a_joint(Effect::JointStiffening)),
    // Named alone it gives way to its load; beside a compliance, a spring that
    // stiffens takes some of it back: 600 urad at 10 N m is 6e-6. How far it gives way at
    // its largest torque says more: a wrist's of a few N m has ten times that.
    plausible: -1e-4..1e-4,
    several: false,
};
