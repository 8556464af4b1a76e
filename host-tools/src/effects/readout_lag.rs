//! The read-out of a joint lags behind its motion. What a gap does, the other way
//! round: it is offered where a gap of the wrong sign was found. Never flashed.

use super::{Family, Offer};
use crate::model::ModelTerm;

pub(super) const FAMILY: Family = Family {
    name: "readout-lag",
    offers: |_| Ok(Vec::new()),
    // What is read is behind, not ahead; more than a quarter of a degree is no lag.
    plausible: -1e-5..5e-3,
    several: false,
};

/// Of a joint counted from 0, of so many that may have it.
#[must_use]
pub fn lag(joint: usize, joints: usize) -> Offer {
    Offer { terms: vec![ModelTerm::Lag { joint, coefficient: 0.0 }], tried: joints as f64 }
}
