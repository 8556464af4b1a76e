//! A periodic error of an order that is tied to nothing known: cos or sin of so
//! many cycles a turn.

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
pub(super) use super::wave::{basis, fold};

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 4,
    name: "joint-periodic-error",
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
