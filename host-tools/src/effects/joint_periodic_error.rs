//! Waves of any order: a scan over all orders finds them, so that nothing is
//! offered before.

use truearm::effects::Effect;

use super::Family;

pub(super) const FAMILY: Family = Family {
    name: Effect::JointPeriodicError.name(),
    offers: |_| Ok(Vec::new()),
    plausible: -2e-2..2e-2,
    several: true,
};
