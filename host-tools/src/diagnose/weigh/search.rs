//! A search: rounds of linearising at the best model so far, weighing every candidate by its
//! evidence, and fitting what was found, until nothing changes.

use super::lines;
use super::nameless;
use super::offered::offered;
use super::partial_fits::{EFFORT, Explained, FIRST};
use super::possible::{self, Possible, listed, members_of};
use super::search_result::Searched;
use super::settled::{With, settled};
use super::sheet::{Sheet, Weights};
use super::start::{Bent, Start};
use super::{between, scattering, unbent, weights};
use crate::diagnose::bending::Bending;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::policy::POLICY;
use crate::diagnose::question::Question;
use crate::error::Result;
use crate::evidence::{Effort, Explanation, Known, explain};
use crate::identify::{Problem, Scatterer, State};

/// How far a search goes: what it weighs at once, and rounds of linearising and weighing.
#[derive(Clone, Copy)]
pub struct Reach {
    effort: Effort,
    rounds: usize,
}

/// To its end.
pub const WHOLE: Reach = Reach { effort: EFFORT, rounds: 4 };
/// The same where joints may err by a curve.
pub const AT_FIRST: Reach = Reach { effort: FIRST, ..WHOLE };
/// As far as it takes to see which joints scatter besides, before all is weighed to its end.
pub const BESIDE_SCATTER: Reach = Reach { rounds: 2, ..WHOLE };

/// Further rounds where physics refuses what was found.
const REFUSALS: usize = 4;

/// Rounds until nothing changes, from where a search begins.
///
/// # Errors
/// When a fit does not converge.
pub fn search(q: &Question, mut now: Start, reach: Reach, progress: &dyn Fn()) -> Result<Searched> {
    now.lines = [lines::of(&now.node.added), now.lines].concat();
    let sources: Vec<Scatterer> = now.scattering.iter().map(|s| s.0).collect();
    let covered = q.problem.data.covered();
    let mut round = 0;
    loop {
        round += 1;
        now.bent.stand_at(&now.node.fit.fit.state);
        let here = Here::at(q, &now, &sources);
        now.even = false;
        let (mut found, next) = here.weighed(q, &now, reach.effort, progress);
        now.scale = found.scale;
        let added: Vec<Candidate> =
            listed(&here.possible, &found.best.members).into_iter().cloned().collect();
        let without_name = possible::nameless(&here.possible, &found);
        let beside = possible::same(&without_name, &now.nameless)
            && scattering::is_settled(&now.scattering, &here.weights.scattering);
        let same = beside && are(&added, &now.node.added);
        let still = beside && lines::are_still(&added, &now.node.added, &covered);
        now.nameless = without_name;
        now.scattering.clone_from(&here.weights.scattering);
        now.lines = lines::of(&added);
        let before = now.bent.clone();
        // What has a name is fitted without it, and rows that it moves far are no tails.
        let apart = nameless::without(q.problem, &here.state, &now.nameless);
        let apart = Question { problem: &apart, ..*q };
        now.refit(&apart, &here, added, (next, same))?;
        let moved = now.bent.moved_from(&before);
        let problem = now.bent.problem(apart.problem);
        let bad = impossible(&problem, &now.node);
        let again = !bad.is_empty() && round < reach.rounds + REFUSALS;
        if !bad.is_empty() {
            now.refuse(&Question { problem: &problem, ..*q }, &here, bad, &mut found)?;
        }
        let settled = still && !moved;
        if !again && (settled || round >= reach.rounds) {
            let ended = settled || reach.rounds >= WHOLE.rounds;
            let still = settled && round == 1;
            return Ok(searched((ended, still), now, before, here, found));
        }
    }
}

/// What a round weighs, and where.
struct Here<'q> {
    problem: Problem<'q>,
    state: State,
    rows: Vec<usize>,
    weights: Weights,
    possible: Vec<Possible>,
    /// How moments bend the springs of the state.
    bending: Option<Bending>,
}

/// Curves and moments that go with what was found.
struct Next {
    bent: Bent,
    /// Springs and moments are then fitted in turn.
    in_turn: bool,
}

impl<'q> Here<'q> {
    /// At the best model so far.
    fn at(q: &Question<'q>, now: &Start, sources: &[Scatterer]) -> Self {
        let problem = now.bent.problem(q.problem);
        let (state, rows) = (now.node.fit.fit.state.clone(), now.node.fit.kept.clone());
        let apart = nameless::without(&problem, &state, &now.nameless);
        let mut weights = weights::after(&apart, &now.node, sources);
        if now.even {
            weights.rows.fill(1.0);
        }
        let asked = Question { problem: &problem, ..*q };
        let known = (&now.lines[..], &now.closed[..], &now.refused[..]);
        let noise = (q.flags.lambda, now.scale);
        let mut possible = offered(&asked, &now.nameless, &now.node, &weights, noise, known);
        possible.retain(|p| !p.is_within(&now.curves));
        let bending = now.bent.bending(&state);
        Self { problem, state, rows, weights, possible, bending }
    }

    /// What explains the rows best, and what goes with it.
    fn weighed(
        &self,
        q: &Question,
        now: &Start,
        effort: Effort,
        progress: &dyn Fn(),
    ) -> (Explanation, Next) {
        let Self { problem, state, rows, weights, possible, bending } = self;
        let (lambda, curves, scale) = (q.flags.lambda, &now.curves[..], now.scale);
        let sheet = Sheet::new(problem, state, possible, weights, curves).bending(
            bending.clone(),
            rows,
            lambda,
        );
        let precision = sheet.precision(lambda);
        let whole = sheet.gram(rows);
        let entries: Vec<_> = possible.iter().map(|p| p.entry.clone()).collect();
        let known = || Known { members: members_of(possible, &now.node.added), scale };
        let known = (scale > 0.0).then(known);
        let found = explain(&whole, &precision, &entries, effort, known.as_ref());
        progress();
        let bending = bending.as_ref();
        let at = unbent::At { problem, state, rows, weights, curves, possible, bending, lambda };
        let found = unbent::reweighed(&at, (&whole, &precision), found);
        let geometry = whole.geometry(&precision, found.scale);
        let all = Explained { q, possible, sheet: &sheet, precision: &precision };
        let solution = all.solution(&whole, &geometry, &found);
        let mut next = now.bent.clone();
        next.find(&sheet, &solution, &geometry);
        // Beside curves, which have a prior that no fit of rows knows, a step at a time;
        // else moments begin where they were: with other members a whole step may lead away.
        let in_turn = curves.is_empty() && !sheet.moments(&solution).is_empty();
        let bent = now.bent.towards(&next, if in_turn { 0.0 } else { 1.0 });
        (found, Next { bent, in_turn })
    }
}

impl Start {
    /// Fits what was found, unless it is the `same` and nothing else has changed.
    fn refit(
        &mut self,
        apart: &Question,
        here: &Here,
        added: Vec<Candidate>,
        (Next { bent, in_turn }, same): (Next, bool),
    ) -> Result<()> {
        self.bent = bent;
        if in_turn {
            let with = With { weights: &here.weights, scale: self.scale };
            (self.node, self.bent) = settled(apart, &added, &here.state, self.bent.clone(), with)?;
        } else if !same || !self.curves.is_empty() {
            let problem = self.bent.problem(apart.problem);
            self.node = fitted(&Question { problem: &problem, ..*apart }, added, &here.state)?;
        }
        Ok(())
    }

    /// Leaves out what no arm has.
    fn refuse(
        &mut self,
        asked: &Question,
        here: &Here,
        bad: Vec<Candidate>,
        found: &mut Explanation,
    ) -> Result<()> {
        self.surely_refused.extend(probable(&bad, &here.possible, found).cloned());
        found.leave_out(|m| here.possible[m].is(&bad));
        let kept = self.node.added.iter().filter(|c| !bad.contains(c)).cloned().collect();
        self.node = fitted(asked, kept, &here.state)?;
        self.refused.extend(bad);
        Ok(())
    }
}

/// Where it ended; curves and moments that its last round was `held` at.
fn searched(
    (ended, still): (bool, bool),
    now: Start,
    held: Bent,
    here: Here,
    found: Explanation,
) -> Searched {
    Searched {
        ended,
        still,
        best: now.node,
        curves: now.curves,
        bent: now.bent,
        state: here.state,
        held,
        rows: here.rows,
        possible: here.possible,
        weights: here.weights,
        found,
        refused: now.refused,
        surely_refused: now.surely_refused,
        closed: now.closed,
    }
}

/// What a fit made of a sign or size that no arm has.
fn impossible(problem: &Problem, node: &Node) -> Vec<Candidate> {
    let mut bad = node.implausible(&problem.conditions);
    bad.extend(between::wild(problem, node));
    bad
}

/// Of these, what the evidence would name.
fn probable<'b>(
    bad: &'b [Candidate],
    possible: &[Possible],
    found: &Explanation,
) -> impl Iterator<Item = &'b Candidate> {
    bad.iter().filter(|candidate| {
        let own = possible.iter().find(|p| p.is(std::slice::from_ref(*candidate)));
        let is = |p: &Possible| found.posterior.probability((&p.entry).into());
        own.is_some_and(|p| is(p) >= POLICY.named)
    })
}

/// Whether these are what a fitted model has.
fn are(members: &[Candidate], added: &[Candidate]) -> bool {
    members.len() == added.len() && members.iter().all(|m| added.iter().any(|a| a.terms == m.terms))
}
