//! The tracker moves against the robot, linearly in time. Never flashed.

use super::{Family, Offer};
use crate::model::ModelTerm;

pub(super) const FAMILY: Family = Family {
    name: "measurement-drift",
    offers: |data| {
        if data.conditions.time { Ok(vec![offer()]) } else { Err("a column time_s") }
    },
    plausible: f64::NEG_INFINITY..f64::INFINITY,
    several: false,
};

fn offer() -> Offer {
    let drift = |component| ModelTerm::Drift { component, coefficient: 0.0 };
    Offer { terms: (0..6).map(drift).collect(), tried: 1.0 }
}
