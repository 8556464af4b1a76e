//! The tracker moves against the robot, with time or the order of rows, on and on or settling. Never flashed.

use std::iter::once;

use super::{Family, Offer};
use crate::model::{Clock, Course, ModelTerm};

pub(super) const FAMILY: Family = Family {
    name: "measurement-drift",
    offers: |data| {
        let conditions = data.conditions;
        match (conditions.time, conditions.ordered) {
            (true, _) => Ok(offers(courses())),
            (false, true) => Ok(offers(of(Clock::Rows, ROWS))),
            (false, false) => Err("a column time_s or order"),
        }
    },
    plausible: f64::NEG_INFINITY..f64::INFINITY,
    several: false,
};

/// Hours in which a floor or a stand settles: minutes after the arm was moved to
/// its place, hours after the hall was heated.
const SETTLING: [f64; 4] = [0.1, 0.3, 1.0, 3.0];

/// The same in thousands of rows, where nobody wrote the time down: of a few hundred rows a
/// thousand is as straight as a line.
const ROWS: [f64; 3] = [0.03, 0.1, 0.3];

/// How what goes with time may go.
pub fn courses() -> impl Iterator<Item = Course> + Clone {
    of(Clock::Time, SETTLING)
}

fn of<const N: usize>(clock: Clock, settling: [f64; N]) -> impl Iterator<Item = Course> + Clone {
    once(clock.goes_on()).chain(settling.map(|settling| clock.settles(settling)))
}

fn offers(courses: impl Iterator<Item = Course> + Clone) -> Vec<Offer> {
    let tried = courses.clone().count() as f64;
    let offer = |course| {
        let drift = |component| ModelTerm::Drift { component, course, coefficient: 0.0 };
        Offer { terms: (0..6).map(drift).collect(), tried }
    };
    courses.map(offer).collect()
}
