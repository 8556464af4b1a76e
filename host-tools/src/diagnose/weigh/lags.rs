//! Read-outs that lag. A gap and a lag move a target alike, the one back and the
//! other on: a gap is weighed first, and where it comes out of the wrong sign, a
//! lag takes its place.

use truearm::JointKind;
use truearm::effects::Effect;

use super::possible::{Numbers, Possible, What, revolute};
use crate::diagnose::candidates::Candidate;
use crate::effects::{self, Offer};
use crate::identify::Problem;

/// Lags of the joints whose gap was refused.
#[must_use]
pub fn offered(problem: &Problem, refused: &[Candidate], numbers: &mut Numbers) -> Vec<Possible> {
    let turning = revolute(problem);
    let mut joints: Vec<usize> = refused.iter().filter_map(gap).map(|joint| joint - 1).collect();
    joints.sort_unstable();
    joints.dedup();
    joints.retain(|joint| problem.nominal[*joint].kind == JointKind::Revolute);
    let lag = |joint| {
        let lag = effects::lag(joint, turning.len());
        let ways = problem.conditions.ways_of_sides(joint);
        numbers.offered(Offer { tried: ways * lag.tried, ..lag }.into())
    };
    joints.into_iter().map(lag).collect()
}

/// Whether it is a gap, at any friction, of a joint whose gap was refused.
#[must_use]
pub fn is_refused(possible: &Possible, refused: &[Candidate]) -> bool {
    let What::Effect(candidate) = &possible.what else { return false };
    let own = gap(candidate);
    own.is_some() && refused.iter().any(|c| gap(c) == own)
}

/// The joint of a gap, counted from 1.
fn gap(candidate: &Candidate) -> Option<usize> {
    let is = candidate.name() == Effect::Backlash.name();
    is.then(|| candidate.joints().first().copied()).flatten()
}
