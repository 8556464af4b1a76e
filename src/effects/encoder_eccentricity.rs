//! An eccentric encoder disc: cos or sin of one or two turns of the joint.

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
pub(super) use super::wave::{basis, fold};

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 2,
    name: "encoder-eccentricity",
    acts_on: ActsOn::Joint,
    coupled: false,
    components: &["cos", "sin"],
    order: Order::Harmonic,
    load: NeedsLoad::Never,
    approach: false,
    warmth: false,
    revolute_only: true,
    units: Units::joint("rad", "m"),
    plausible: 5e-2,
    usual: 1e-3,
};
