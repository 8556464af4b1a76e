//! How fast a drift of the model settles: times beside its own are candidates in the next
//! round, as the orders of lines are.

use crate::diagnose::candidates::Candidate;
use crate::model::{Course, ModelTerm};

/// Times over that of the model: four rounds go as far as from one that is offered to the next.
const BESIDE: [f64; 5] = [0.7, 0.84, 1.0, 1.19, 1.43];

/// The drifts of a fitted model and those with other times, but for what is offered anyway.
pub fn near(added: &[Candidate], offered: &[Candidate]) -> impl Iterator<Item = Candidate> {
    let drifts = added.iter().filter_map(|candidate| match candidate.terms.first() {
        Some(ModelTerm::Drift { course: Course { clock, settling: Some(settling) }, .. }) => {
            Some((candidate, *clock, *settling))
        }
        _ => None,
    });
    let all = drifts.flat_map(|(candidate, clock, settling)| {
        BESIDE.map(|times| {
            let mut other = candidate.clone();
            for term in &mut other.terms {
                if let ModelTerm::Drift { course, .. } = term {
                    *course = clock.settles(settling * times);
                }
                *term.coefficient_mut() = 0.0;
            }
            other
        })
    });
    all.filter(|c| offered.iter().all(|other| other.terms != c.terms))
}
