//! All links grow alike, or one that stands by a heat source.

use std::iter::once;

use truearm::Link;
use truearm::effects::Effect;

use super::{Data, Family, Offer};

const EFFECT: Effect = Effect::ThermalExpansion;

pub(super) const FAMILY: Family = Family {
    name: EFFECT.name(),
    offers,
    // Aluminium grows by 2.4e-5 a kelvin, plastics by three times that, and joints warm up
    // more than the air does that was read.
    plausible: -1e-5..2e-4,
    several: false,
};

/// Time constants that are tried, s: thin links by a motor, to a cast base in a hall.
const SHORTEST: f64 = 30.0;
const LONGEST: f64 = 40_000.0;
/// The next one over one.
const NEXT: f64 = 2.0;

/// One that is shorter than this share of the time from row to row is none...
const LEAST_STEPS: f64 = 0.25;
/// ...and of one longer than so many sessions only the beginning of its rise is seen, which
/// goes with all longer ones alike.
const MOST_SESSIONS: f64 = 2.0;

/// How many times as many a time constant counts for: as links follow what is read at once
/// with one coefficient less, a tenth of the name's prior is that of following it late.
const LATE: f64 = 10.0;

fn offers(data: &Data) -> Result<Vec<Offer>, &'static str> {
    if !data.conditions.temperature {
        return Err("a column temperature_c that varies");
    }
    let links: Vec<_> = data.robot.joints.iter().map(|joint| joint.link).collect();
    let at_once = growing(&links);
    let constants = constants(data.conditions.warming);
    let price = LATE * constants.len() as f64;
    let late = constants.iter().flat_map(|tau| at_once.iter().map(|o| o.late(*tau, price)));
    Ok(at_once.iter().cloned().chain(late.collect::<Vec<_>>()).collect())
}

/// Time constants that rows at these times may tell from none, s.
fn constants(times: Option<[f64; 2]>) -> Vec<f64> {
    let Some([step, session]) = times else { return Vec::new() };
    let all = std::iter::successors(Some(SHORTEST), |tau| Some(tau * NEXT));
    let told = |tau: &f64| (LEAST_STEPS * step..=MOST_SESSIONS * session).contains(tau);
    all.take_while(|tau| *tau < LONGEST).filter(told).collect()
}

/// All links together, and each that has a length.
pub fn growing(links: &[Link<f64>]) -> Vec<Offer> {
    let long = |j: &usize| links[*j].parameters.a != 0.0 || links[*j].parameters.d != 0.0;
    // One link alone is rare: as if four times as many were tried.
    let alone = |j: usize| Offer::of_arm(EFFECT, &[j], &[0.0], 4 * links.len());
    let each = (0..links.len()).filter(long).map(alone);
    once(Offer::of_arm(EFFECT, &[], &[0.0], 1)).chain(each).collect()
}
