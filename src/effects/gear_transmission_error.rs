//! A gear's kinematic error: cos or sin of a multiple of the gear ratio a turn.

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
pub(super) use super::wave::{basis, fold};

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 3,
    name: "gear-transmission-error",
    acts_on: ActsOn::Joint,
    coupled: false,
    components: &["cos", "sin"],
    order: Order::Cycles,
    load: NeedsLoad::Never,
    approach: false,
    warmth: false,
    revolute_only: true,
    units: Units::joint("rad", "m"),
    plausible: 5e-2,
    usual: 1e-3,
};
