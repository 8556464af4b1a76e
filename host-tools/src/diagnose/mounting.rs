//! An arm of which nobody said how it is mounted: it stands; where springs would give way
//! upwards then it hangs; and where they do so either way nobody knows.

use super::bending::bends;
use super::outcome::Verdict;
use super::shown::Diagnosis;
use crate::error::Result;
use crate::model::Mounting;

/// What is left of springs that no direction along z bends.
const NEITHER: &str = "springs, but neither as of an arm that stands nor of one that hangs: state \
                       gravity_m_s2";

/// The diagnosis as the arm is mounted. Springs that are named and leave nothing but noise
/// say that it stands, though another of a joint that hardly bends was refused on the way.
///
/// # Errors
/// As of the first.
pub fn tried(with: &dyn Fn(Mounting) -> Result<Diagnosis>) -> Result<Diagnosis> {
    let mut upright = with(Mounting::Upright)?;
    if !upright.against_gravity {
        return Ok(upright);
    }
    let stands = upright.outcome.verdict == Verdict::Explained && has_springs(&upright);
    match with(Mounting::Hanging) {
        Ok(hanging) if !hanging.against_gravity && (has_springs(&hanging) || !stands) => {
            Ok(hanging)
        }
        // One that a few rows make probable and gravity does not may be noise.
        _ if stands || !upright.surely_against => Ok(upright),
        _ => {
            upright.outcome.verdict = Verdict::Unexplained;
            upright.outcome.unnamed.push(NEITHER.to_owned());
            Ok(upright)
        }
    }
}

/// Whether springs are named.
fn has_springs(of: &Diagnosis) -> bool {
    of.outcome.effects.iter().any(|effect| bends(effect.name))
}
