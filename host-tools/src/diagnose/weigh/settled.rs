//! Springs and the moments that bend them, fitted in turn until neither moves.

use super::partial_fits::Explained;
use super::possible::Numbers;
use super::sheet::{Sheet, Weights};
use super::start::Bent;
use crate::diagnose::bending::is_spring;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::question::Question;
use crate::error::Result;
use crate::evidence::Subsets;
use crate::identify::State;

/// Most rounds; two or three do where masses are stated.
const ROUNDS: usize = 12;
/// Shares of a step of the moments that are tried: what a spring bends is a product of two
/// unknowns, and a whole step may lead away.
const SHARES: [f64; 4] = [1.0, 0.5, 0.2, 0.05];
/// Share of the cost that a round must take off.
const LESS: f64 = 1e-3;

/// What the fits are made with.
#[derive(Clone, Copy)]
pub struct With<'s> {
    /// Noise of the rows.
    pub weights: &'s Weights,
    /// Noise over the stated sigma.
    pub scale: f64,
}

/// Effects fitted from a state, and where they have springs the moments that suit them.
/// The cost, misfit and what the moments are off by, falls in every round.
///
/// # Errors
/// When a fit does not converge.
pub fn settled(
    q: &Question,
    added: &[Candidate],
    state: &State,
    mut bent: Bent,
    with: With,
) -> Result<(Node, Bent)> {
    let fit = |bent: &Bent, near: &State| {
        fitted(&Question { problem: &bent.problem(q.problem), ..*q }, added.to_vec(), near)
    };
    let mut node = fit(&bent, state)?;
    if bent.moments.is_none() || !added.iter().any(|c| is_spring(c.name())) {
        return Ok((node, bent));
    }
    let cost = |node: &Node, bent: &Bent| {
        let gross = q.flags.gross.powi(2) * node.fit.outliers.len() as f64;
        let moments = bent.moments.as_ref().map_or(0.0, |moments| moments.norm_squared());
        (node.misfit + gross) / with.scale.powi(2) + moments
    };
    let mut least = cost(&node, &bent);
    for _ in 0..ROUNDS {
        let next = solved(q, &node, &bent, with);
        let near = node.fit.fit.state.clone();
        let mut better = None;
        for share in SHARES {
            let part = bent.towards(&next, share);
            let Ok(tried) = fit(&part, &near) else { continue };
            let own = cost(&tried, &part);
            if own < least {
                better = Some((own, tried, part));
                break;
            }
        }
        let Some((own, tried, part)) = better else { break };
        let rest = own > (1.0 - LESS) * least;
        (least, node, bent) = (own, tried, part);
        if rest {
            break;
        }
    }
    Ok((node, bent))
}

/// Moments that go with the effects of a node, all coefficients free.
fn solved(q: &Question, node: &Node, bent: &Bent, with: With) -> Bent {
    let problem = bent.problem(q.problem);
    let asked = Question { problem: &problem, ..*q };
    let state = &node.fit.fit.state;
    let mut numbers = Numbers::default();
    let possible: Vec<_> = node.added.iter().map(|c| numbers.offered(c.clone())).collect();
    let members: Vec<usize> = (0..possible.len()).collect();
    let entries: Vec<_> = possible.iter().map(|p| p.entry.clone()).collect();
    let sheet = Sheet::new(&problem, state, &possible, with.weights, &[]).bending(
        bent.bending(state),
        &node.fit.kept,
        q.flags.lambda,
    );
    let precision = sheet.precision(q.flags.lambda);
    let gram = sheet.gram(&node.fit.kept);
    let geometry = gram.geometry(&precision, with.scale);
    let subsets = Subsets::new(gram.project(&geometry), entries);
    let subset = subsets.fit(&members, &|_| None);
    let coefficients = subsets.coefficients(&subset);
    let all = Explained { q: &asked, possible: &possible, sheet: &sheet, precision: &precision };
    let solution = all.of_subset(&gram, &geometry, &subset, &coefficients);
    let mut next = bent.clone();
    next.find(&sheet, &solution, &geometry);
    next
}
