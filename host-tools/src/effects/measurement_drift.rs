//! The tracker moves against the robot, with time, settling, or with the order of rows. Never flashed.

use std::iter::once;

use super::{Family, Offer};
use crate::model::{Course, ModelTerm};

pub(super) const FAMILY: Family = Family {
    name: "measurement-drift",
    offers: |data| {
        let conditions = data.conditions;
        match (conditions.time, conditions.ordered) {
            (true, _) => Ok(offers(courses())),
            (false, true) => Ok(offers(once(Course::Rows))),
            (false, false) => Err("a column time_s or order"),
        }
    },
    plausible: f64::NEG_INFINITY..f64::INFINITY,
    several: false,
};

/// Hours in which a floor or a stand settles: minutes after the arm was moved to
/// its place, hours after the hall was heated.
const SETTLING: [f64; 4] = [0.1, 0.3, 1.0, 3.0];

/// How what goes with time may go.
pub fn courses() -> impl Iterator<Item = Course> + Clone {
    once(Course::Time).chain(SETTLING.map(Course::Settling))
}

fn offers(courses: impl Iterator<Item = Course> + Clone) -> Vec<Offer> {
    let tried = courses.clone().count() as f64;
    let offer = |course| {
        let drift = |component| ModelTerm::Drift { component, course, coefficient: 0.0 };
        Offer { terms: (0..6).map(drift).collect(), tried }
    };
    courses.map(offer).collect()
}
