//! Springs of an arm that nobody weighed, alone with the moments that bend them.

use super::settled::{With, settled};
use super::sheet::Weights;
use super::start::Bent;
use crate::diagnose::bending::is_spring;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::Node;
use crate::diagnose::question::Question;
use crate::error::Result;
use crate::identify::State;

/// Where springs were found with assumed masses: those springs fitted alone with
/// moments that suit them. What moments of the wrong shape leave would get names
/// otherwise that keep the moments where they are.
///
/// # Errors
/// When a fit does not converge.
pub fn sprung(
    q: &Question,
    (found, state): (&[Candidate], &State),
    weights: &Weights,
    scale: f64,
) -> Result<Option<(Node, Bent)>> {
    let springs: Vec<Candidate> = found.iter().filter(|c| is_spring(c.name())).cloned().collect();
    let Some(moments) = q.moments.filter(|m| m.are_assumed() && !springs.is_empty()) else {
        return Ok(None);
    };
    let mut bent = Bent { tables: Vec::new(), moments: Some(moments.clone()) };
    bent.stand_at(state);
    let with = With { weights, scale };
    settled(q, &springs, state, bent, with).map(Some)
}
