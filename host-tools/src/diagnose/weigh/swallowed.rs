//! Structure that passed for heavy tails of the noise, or for gross errors.
//!
//! What rows weigh, and which are flagged, is judged by what a fit leaves. Where geometry
//! leaves the most in few rows, they are flagged or weigh next to nothing until no evidence of
//! an effect is left in them, and the search ends with the tails that it began with. It is told
//! by how heavy they are, or by how many rows are flagged; another search then begins with all
//! rows alike, and the better explanation stays.

use super::search_result::Searched;
use super::weights;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::question::Question;
use crate::evidence::tails::{Rest, Tails};
use crate::identify::Scatterer;
use crate::identify::fit::robust::Flags;

/// RMS over the scale of the core from which on tails are not believed: the heaviest that
/// are tried, of three degrees of freedom, have 1.73.
const TOO_HEAVY: f64 = 2.0;
/// Share of rows flagged from which on it is asked whether they are wrong.
const TOO_MANY: f64 = 0.01;
/// What an effect pays for having been looked for, nats: a name's prior shared by the
/// places and sizes that it may have.
const LOOKED_FOR: f64 = 8.0;

/// Geometry fitted to all rows alike, where a search from it may have lost its evidence.
#[must_use]
pub fn all_alike(q: &Question, root: &Node, found: &Searched) -> Option<Node> {
    let flagged = found.best.fit.outliers.len() as f64 > TOO_MANY * q.rows.len() as f64;
    if !flagged && !is_heavy(q, found) {
        return None;
    }
    let unflagged = Question { flags: Flags { gross: f64::INFINITY, ..q.flags }, ..*q };
    // What is metres off fits nothing: it stays flagged.
    fitted(&unflagged, Vec::new(), &root.fit.fit.state).ok()
}

/// Whether another search found more, and explains the same poses better, its effects paid.
#[must_use]
pub fn is_better(q: &Question, other: &Searched, found: &Searched) -> bool {
    !other.best.added.is_empty() && cost(q, other) < cost(q, found)
}

fn is_heavy(q: &Question, found: &Searched) -> bool {
    let rests = left(q, found);
    let equations: usize = rests.iter().map(|r| r.equations).sum();
    let square: f64 = rests.iter().map(|r| r.square).sum();
    let (tails, _) = tails(found, &rests);
    tails.nu.is_finite() && (square / equations.max(1) as f64).sqrt() > TOO_HEAVY * tails.scale
}

fn left(q: &Question, found: &Searched) -> Vec<Rest> {
    let sources: Vec<Scatterer> = found.weights.scattering.iter().map(|s| s.0).collect();
    weights::left(&found.bent.problem(q.problem), &found.best, &sources)
}

fn tails(found: &Searched, rests: &[Rest]) -> (Tails, f64) {
    Tails::with_likelihood(rests, found.best.fit.used.min(rests.len() as f64))
}

/// Nats: what is left and was flagged, and of the effects a name and half a logarithm of
/// the poses for each coefficient.
fn cost(q: &Question, found: &Searched) -> f64 {
    let rests = left(q, found);
    let (_, likelihood) = tails(found, &rests);
    let fit = &found.best.fit;
    let flagged = (fit.outliers.len() * rests.len()) as f64 / fit.kept.len().max(1) as f64;
    let coefficients: usize = found.best.added.iter().map(|c| c.terms.len()).sum();
    let names = LOOKED_FOR * found.best.added.len() as f64;
    let paid = names + 0.5 * coefficients as f64 * (rests.len().max(2) as f64).ln();
    paid + 0.5 * q.flags.gross.powi(2) * flagged - likelihood
}
