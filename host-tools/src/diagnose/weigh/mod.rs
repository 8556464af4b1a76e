//! What the data hold beyond geometry: rounds of linearising at the best model
//! so far, weighing every candidate by its evidence, and fitting what was found.

mod answer;
mod chosen;
mod curved;
mod curves;
mod explained;
mod halves;
mod judge;
mod lags;
mod lines;
mod nameless;
mod parts;
mod possible;
pub mod scan;
mod sheet;
pub mod slips;
mod sprung;
mod weights;

use std::sync::Arc;

use super::candidates::Candidate;
use super::moments::Moments;
use super::node::{Node, fitted};
use super::policy::POLICY;
use super::question::Question;
use crate::error::Result;
use crate::evidence::{Effort, Explanation, Known, explain};
use crate::identify::{Problem, State};
use crate::model::ErrorCurve;
pub use answer::{Curved, Named, Stage, Weighed};
use curves::Curve;
use explained::{EFFORT, Explained, FIRST};
use lines::Held;
pub use nameless::Nameless;
use parts::{Parts, joined};
use possible::{Numbers, Possible, listed, revolute};
use sheet::Sheet;
pub use sheet::Weights;
use sprung::sprung;

/// Rounds of linearising and weighing.
const ROUNDS: usize = 4;

/// Further rounds where physics refuses what was found.
const REFUSALS: usize = 4;

/// Weighs everything, from a fit of geometry: first without error curves; where
/// joints turn out to have some, again from nothing beside them.
///
/// # Errors
/// When a fit does not converge.
pub fn weigh(q: &Question, root: &Node, progress: &dyn Fn()) -> Result<Weighed> {
    let mut plain = search(q, Start::at(q, root), FIRST, progress)?;
    let found = (&plain.best.added[..], &plain.best.fit.fit.state);
    if let Some((node, moments)) = sprung(q, found, &plain.weights, plain.found.scale)? {
        let start = Start { moments: Some(moments), ..Start::at(q, &node) };
        plain = search(q, start, FIRST, progress)?;
    }
    let curves = plain.curves_wanted(q, &bent(q.problem, plain.moments.as_ref(), &[]));
    if curves.is_empty() {
        let found = match plain.found.best.members.len() < FIRST.members {
            true => plain,
            // It went as far as it was let: farther.
            false => search(q, plain.again(), EFFORT, progress)?,
        };
        return found.judged(q);
    }
    let (scale, refused) = (plain.found.scale, plain.refused);
    let moments = plain.moments.clone();
    let start = Start { curves, scale, refused, moments, ..Start::at(q, root) };
    let first = search(q, start, FIRST, progress)?;
    // At the noise that is left now, lengths and sizes are told better.
    let problem = bent(q.problem, first.moments.as_ref(), &first.tables);
    let curves = first.curves_wanted(q, &problem);
    let mut again = Start { curves, ..first.again() };
    // A curve that is no longer wanted must not stay in what is predicted.
    again.tables.retain(|t| again.curves.iter().any(|c| c.joint == usize::from(t.joint())));
    search(q, again, EFFORT, progress)?.judged(q)
}

/// Where a search begins.
struct Start {
    node: Node,
    curves: Vec<Curve>,
    tables: Vec<ErrorCurve>,
    /// Noise over the stated sigma, 0 where it is not known yet.
    scale: f64,
    /// What physics refused.
    refused: Vec<Candidate>,
    moments: Option<Moments>,
}

impl Start {
    /// At a fit of which nothing else is known.
    fn at(q: &Question, root: &Node) -> Self {
        Self {
            node: root.clone(),
            curves: Vec::new(),
            tables: Vec::new(),
            scale: 0.0,
            refused: Vec::new(),
            moments: q.moments.cloned(),
        }
    }
}

/// Where it ends: what was weighed in the last round, and the fit of what it found.
struct Searched {
    best: Node,
    curves: Vec<Curve>,
    tables: Vec<ErrorCurve>,
    moments: Option<Moments>,
    /// State, tables and moments that it was weighed at.
    state: State,
    held: Vec<ErrorCurve>,
    held_moments: Option<Moments>,
    rows: Vec<usize>,
    possible: Vec<Possible>,
    weights: Weights,
    found: Explanation,
    refused: Vec<Candidate>,
}

/// A problem whose joints err by these curves.
#[must_use]
pub fn with_curves<'a>(problem: &Problem<'a>, tables: &[ErrorCurve]) -> Problem<'a> {
    if tables.is_empty() {
        return problem.clone();
    }
    let conditions = (*problem.conditions).clone().with_curves(problem.data, tables);
    Problem { conditions: Arc::new(conditions), ..problem.clone() }
}

/// The same at the loads that were found.
fn bent<'a>(
    problem: &Problem<'a>,
    moments: Option<&Moments>,
    tables: &[ErrorCurve],
) -> Problem<'a> {
    let loaded = moments.map(|m| m.loaded(problem));
    with_curves(loaded.as_ref().unwrap_or(problem), tables)
}

/// Rounds of linearising, weighing and fitting until nothing changes.
fn search(q: &Question, start: Start, effort: Effort, progress: &dyn Fn()) -> Result<Searched> {
    let Start { mut node, curves, mut tables, mut scale, mut refused, mut moments } = start;
    let lambda = q.flags.lambda;
    let mut held = lines_of(&node.added);
    let mut round = 0;
    loop {
        round += 1;
        let problem = bent(q.problem, moments.as_ref(), &tables);
        let asked = Question { problem: &problem, ..*q };
        let (state, rows) = (node.fit.fit.state.clone(), node.fit.kept.clone());
        let weights = weights::after(&problem, &node);
        let mut possible = candidates(&asked, &node, &weights, (lambda, scale), (&held, &refused));
        let barred = |p: &Possible| p.is(&refused) || lags::is_refused(p, &refused);
        possible.retain(|p| !barred(p) && !p.is_within(&curves));
        let bending = moments.as_ref().and_then(|m| m.bending(&state));
        let sheet = Sheet::new(&problem, &state, &possible, &weights, &curves).bending(bending);
        let precision = sheet.precision(lambda);
        let whole = sheet.gram(&rows);
        let entries: Vec<_> = possible.iter().map(|p| p.entry.clone()).collect();
        let known = (scale > 0.0).then(|| Known { members: members_of(&possible, &node), scale });
        let mut found = explain(&whole, &precision, &entries, effort, known.as_ref());
        progress();
        scale = found.scale;
        let members: Vec<&Candidate> = listed(&possible, &found.best.members);
        let same = are(&members, &node.added);
        let added: Vec<Candidate> = members.into_iter().cloned().collect();
        held = lines_of(&added);
        let geometry = whole.geometry(&precision, scale);
        let explained = Explained { q, possible: &possible, sheet: &sheet, precision: &precision };
        let solution = explained.solution(&whole, &geometry, &found);
        let held_tables = std::mem::replace(&mut tables, sheet.tables(&solution, &geometry));
        let held_moments = moments.clone();
        let found_moments = sheet.moments(&solution);
        let moved = moments.as_mut().is_some_and(|moments| moments.find(found_moments));
        let problem = bent(q.problem, moments.as_ref(), &tables);
        let asked = Question { problem: &problem, ..*q };
        if !same || !curves.is_empty() || !found_moments.is_empty() {
            node = fitted(&asked, added, &state)?;
        }
        let bad = node.implausible(&problem.conditions);
        let again = !bad.is_empty() && round < ROUNDS + REFUSALS;
        if !bad.is_empty() {
            let kept = node.added.iter().filter(|c| !bad.contains(c)).cloned().collect();
            found.leave_out(|m| possible[m].is(&bad));
            refused.extend(bad);
            node = fitted(&asked, kept, &state)?;
        }
        if !again && (same && !moved || round >= ROUNDS) {
            drop(sheet);
            return Ok(Searched {
                best: node,
                curves,
                tables,
                moments,
                state,
                held: held_tables,
                held_moments,
                rows,
                possible,
                weights,
                found,
                refused,
            });
        }
    }
}

impl Searched {
    /// A new search from here.
    fn again(&self) -> Start {
        Start {
            node: self.best.clone(),
            curves: self.curves.clone(),
            tables: self.tables.clone(),
            scale: self.found.scale,
            refused: self.refused.clone(),
            moments: self.moments.clone(),
        }
    }

    /// Joints that have an error curve beside what was found.
    fn curves_wanted(&self, q: &Question, problem: &Problem) -> Vec<Curve> {
        let members = self.found.best.members.iter();
        let members: Vec<Possible> = members.map(|m| self.possible[*m].clone()).collect();
        let (state, rows) = (&self.best.fit.fit.state, &self.best.fit.kept);
        let noise = (q.flags.lambda, self.found.scale);
        chosen::chosen(problem, state, rows, &members, &self.weights, noise)
    }

    /// The answer.
    fn judged(self, q: &Question) -> Result<Weighed> {
        let problem = bent(q.problem, self.held_moments.as_ref(), &self.held);
        let asked = Question { problem: &problem, ..*q };
        let bending = self.held_moments.as_ref().and_then(|m| m.bending(&self.state));
        let sheet = Sheet::new(&problem, &self.state, &self.possible, &self.weights, &self.curves)
            .bending(bending);
        let precision = sheet.precision(q.flags.lambda);
        let parts = Parts::new(&asked, &self.rows);
        let grams = sheet.grams(&parts.rows);
        let whole = joined(grams.iter(), sheet.size());
        let all =
            Explained { q: &asked, possible: &self.possible, sheet: &sheet, precision: &precision };
        let within = judge::within(&all, &whole, &self.found);
        let no_room = self.best.added.len().saturating_sub(within.len());
        let best = match within.len() == self.best.added.len() {
            true => self.best,
            false => {
                let problem = bent(q.problem, self.moments.as_ref(), &self.tables);
                fitted(&Question { problem: &problem, ..*q }, within, &self.state)?
            }
        };
        let mut answer = judge::answer(&all, best, &self.found, &parts, &grams);
        answer.moments = self.moments;
        answer.no_room = no_room;
        if !self.curves.is_empty() {
            let from = curved::From { all: &all, found: &self.found, parts: &parts, grams: &grams };
            answer.stages = curved::stages(&from);
            // The model is the last stage.
            let tables = answer.stages.last().map_or(&[][..], |stage| &stage.tables);
            answer.curves = curved::worth(&from, &self.curves, tables);
        }
        Ok(answer)
    }
}

/// Everything that is weighed in a round at a model: lines near those it had, and
/// what stands in for a refused one.
fn candidates(
    q: &Question,
    node: &Node,
    weights: &Weights,
    noise: (f64, f64),
    (held, refused): (&[Held], &[Candidate]),
) -> Vec<Possible> {
    let (state, rows) = (&node.fit.fit.state, &node.fit.kept);
    let mut numbers = Numbers::default();
    let mut out: Vec<Possible> =
        q.offered.iter().map(|candidate| numbers.offered(candidate.clone())).collect();
    out.extend(lags::offered(q.problem, refused, &mut numbers));
    let columns = scan::joints(q.problem, state, rows, weights, noise);
    out.extend(lines::offered(state, &columns, q.highest_order, held, &mut numbers));
    out.extend(slips::offered(q.problem, rows, &columns, &mut numbers));
    let joints = revolute(q.problem);
    for (nameless, tried) in Nameless::all(q.problem, &joints, POLICY.wobbles) {
        out.push(numbers.nameless(nameless, tried));
    }
    out
}

/// Whether these are what a fitted model has.
fn are(members: &[&Candidate], added: &[Candidate]) -> bool {
    members.len() == added.len() && members.iter().all(|m| added.iter().any(|a| a.terms == m.terms))
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
