//! Springs of an arm that nobody weighed, alone with the moments that bend them.

use super::explained::Explained;
use super::possible::Numbers;
use super::sheet::{Sheet, Weights};
use super::start::Bent;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::moments::bends;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::question::Question;
use crate::error::Result;
use crate::evidence::Subsets;
use crate::identify::State;

/// Rounds of fitting springs and moments in turn.
const ROUNDS: usize = 4;

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
    let spring = |c: &&Candidate| bends(c.name());
    let springs: Vec<Candidate> = found.iter().filter(spring).cloned().collect();
    let Some(moments) = q.moments.filter(|m| m.are_assumed() && !springs.is_empty()) else {
        return Ok(None);
    };
    let mut bent = Bent { tables: Vec::new(), moments: Some(moments.clone()) };
    let mut node = fitted(q, springs.clone(), state)?;
    let mut numbers = Numbers::default();
    let possible: Vec<_> = springs.iter().map(|c| numbers.offered(c.clone())).collect();
    let members: Vec<usize> = (0..possible.len()).collect();
    let entries: Vec<_> = possible.iter().map(|p| p.entry.clone()).collect();
    for _ in 0..ROUNDS {
        let problem = bent.problem(q.problem);
        let state = node.fit.fit.state.clone();
        let sheet =
            Sheet::new(&problem, &state, &possible, weights, &[]).bending(bent.bending(&state));
        let precision = sheet.precision(q.flags.lambda);
        let gram = sheet.gram(&node.fit.kept);
        let geometry = gram.geometry(&precision, scale);
        let subsets = Subsets::new(gram.project(&geometry), entries.clone());
        let subset = subsets.fit(&members, &|_| None);
        let coefficients = subsets.coefficients(&subset);
        let all = Explained { q, possible: &possible, sheet: &sheet, precision: &precision };
        let solution = all.of_subset(&gram, &geometry, &subset, &coefficients);
        bent.find(&sheet, &solution, &geometry);
        let problem = bent.problem(q.problem);
        node = fitted(&Question { problem: &problem, ..*q }, springs.clone(), &state)?;
    }
    Ok(Some((node, bent)))
}
