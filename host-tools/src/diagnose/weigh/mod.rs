//! What the data hold beyond geometry: rounds of linearising at the best model
//! so far, weighing every candidate by its evidence, and fitting what was found.

mod answer;
mod explained;
mod halves;
mod judge;
mod lines;
mod nameless;
mod parts;
mod possible;
pub mod scan;
mod sheet;
pub mod slips;
mod weights;

use super::candidates::Candidate;
use super::node::{Node, fitted};
use super::policy::POLICY;
use super::question::Question;
use crate::error::Result;
use crate::evidence::{Known, explain};
use crate::identify::State;
pub use answer::{Named, Weighed};
use explained::{EFFORT, Explained};
use lines::Held;
pub use nameless::Nameless;
use parts::{Parts, joined};
use possible::{Numbers, Possible, listed, revolute};
use sheet::Sheet;
pub use sheet::Weights;

/// Rounds of linearising and weighing.
const ROUNDS: usize = 4;

/// Weighs everything, from a fit of geometry.
///
/// # Errors
/// When a fit does not converge.
pub fn weigh(question: &Question, root: &Node, progress: &dyn Fn()) -> Result<Weighed> {
    let q = question;
    let mut node = root.clone();
    let mut held: Vec<Held> = Vec::new();
    let mut scale = 0.0;
    let mut weights = weights::after(q.problem, &node);
    let lambda = q.flags.lambda;
    let mut refused: Vec<Candidate> = Vec::new();
    let mut round = 0;
    loop {
        round += 1;
        let state = node.fit.fit.state.clone();
        let rows = node.fit.kept.clone();
        let mut numbers = Numbers::default();
        let possible = candidates(q, &state, &rows, &weights, (lambda, scale), &held, &mut numbers);
        let possible: Vec<Possible> = possible.into_iter().filter(|p| !p.is(&refused)).collect();
        let sheet = Sheet::new(q.problem, &state, &possible, &weights);
        let precision = sheet.precision(lambda);
        let parts = Parts::new(q, &rows);
        let grams = sheet.grams(&parts.rows);
        let whole = joined(grams.iter());
        let entries: Vec<_> = possible.iter().map(|p| p.entry.clone()).collect();
        let known = (round > 1).then(|| Known { members: members_of(&possible, &node), scale });
        let found = explain(&whole, &precision, &entries, EFFORT, known.as_ref());
        progress();
        scale = found.scale;
        let members: Vec<&Candidate> = listed(&possible, &found.best.members);
        let same = members.len() == node.added.len()
            && members.iter().all(|m| node.added.iter().any(|a| a.terms == m.terms));
        let added: Vec<Candidate> = members.into_iter().cloned().collect();
        held = lines_of(&added);
        if same || round == ROUNDS {
            let all = Explained { q, possible: &possible, sheet: &sheet, precision: &precision };
            let within = judge::within(&all, &whole, &found);
            let best =
                if same && within.len() == added.len() { node } else { fitted(q, within, &state)? };
            return Ok(judge::answer(&all, best, &found, &parts, &grams));
        }
        node = fitted(q, added, &state)?;
        let bad = node.implausible();
        if !bad.is_empty() && round < ROUNDS {
            let kept = node.added.iter().filter(|c| !bad.contains(c)).cloned().collect();
            refused.extend(bad);
            node = fitted(q, kept, &state)?;
        }
        weights = weights::after(q.problem, &node);
    }
}

/// Everything that is weighed in a round.
fn candidates(
    q: &Question,
    state: &State,
    rows: &[usize],
    weights: &Weights,
    noise: (f64, f64),
    held: &[Held],
    numbers: &mut Numbers,
) -> Vec<Possible> {
    let mut out: Vec<Possible> =
        q.offered.iter().map(|candidate| numbers.offered(candidate.clone())).collect();
    let columns = scan::joints(q.problem, state, rows, weights, noise);
    out.extend(lines::offered(state, &columns, q.highest_order, held, numbers));
    out.extend(slips::offered(q.problem, rows, &columns, numbers));
    let joints = revolute(q.problem);
    for (nameless, tried) in Nameless::all(q.problem, &joints, POLICY.wobbles) {
        out.push(numbers.nameless(nameless, tried));
    }
    out
}

/// Which of the candidates a fitted model has.
fn members_of(possible: &[Possible], node: &Node) -> Vec<usize> {
    (0..possible.len()).filter(|k| possible[*k].is(&node.added)).collect()
}

fn lines_of(added: &[Candidate]) -> Vec<Held> {
    let line = |c: &&Candidate| c.name() == truearm::effects::Effect::JointPeriodicError.name();
    let held = added.iter().filter(line).filter_map(|c| {
        let term = c.terms.first()?;
        Some((term.joints().first()? - 1, term.order()?))
    });
    held.collect()
}
