//! What the data hold beyond geometry: rounds of linearising at the best model
//! so far, weighing every candidate by its evidence, and fitting what was found.

mod between;
mod curve;
mod doubts;
mod follows;
mod given_back;
mod gross;
mod halves;
mod joint_curves;
mod judge;
mod lags;
mod late;
mod lines;
mod nameless;
mod partial_fits;
mod possible;
mod rescan;
mod row_parts;
pub mod scan;
mod scattering;
mod screen;
mod search_result;
mod settled;
mod settling;
mod sheet;
pub mod slips;
mod start;
pub mod start_sides;
mod swallowed;
mod unbent;
mod unweighed_springs;
mod weighed;
mod weights;

use super::candidates::Candidate;
use super::node::{Node, fitted};
use super::policy::POLICY;
use super::question::Question;
use crate::error::Result;
use crate::evidence::{Effort, Explanation, Known, explain};
use crate::identify::{Problem, Scatterer};
use curve::Curve;
pub use follows::{Covariate, Follows};
use given_back::given_back;
pub use gross::gross;
use joint_curves::choice::Chosen;
use lines::Held;
pub use nameless::{Nameless, without};
use partial_fits::{EFFORT, Explained, FIRST};
pub use possible::What;
use possible::{Numbers, Possible, listed, revolute};
use search_result::Searched;
use settled::{With, settled};
use sheet::Sheet;
pub use sheet::{Scattered, Weights, along};
use start::Start;
pub use start::with_curves;
use unweighed_springs::sprung;
pub use weighed::{Curved, Doubt, Named, Stage, Unnamed, Weighed};
pub use weights::scatter;

/// How far a search goes: what it weighs at once, and rounds of linearising and weighing.
#[derive(Clone, Copy)]
struct Reach {
    effort: Effort,
    rounds: usize,
}

/// To its end.
const WHOLE: Reach = Reach { effort: EFFORT, rounds: 4 };
/// The same where joints may err by a curve.
const AT_FIRST: Reach = Reach { effort: FIRST, ..WHOLE };
/// As far as it takes to see which joints scatter besides, before all is weighed to its end.
const BESIDE_SCATTER: Reach = Reach { rounds: 2, ..WHOLE };

/// Further rounds where physics refuses what was found.
const REFUSALS: usize = 4;

/// Rounds of finding the orders of lines anew without a part of the poses.
const RESCANS: usize = 3;

/// Weighs everything, from a fit of geometry: first without error curves; where
/// joints turn out to have some, again from nothing beside them.
///
/// # Errors
/// When a fit does not converge.
pub fn weigh(q: &Question, root: &Node, progress: &dyn Fn()) -> Result<Weighed> {
    let regained = given_back(q, root);
    let root = regained.as_ref().unwrap_or(root);
    let (begin, mut plain) = from_geometry(q, root, progress)?;
    let found = (&plain.best.added[..], &plain.best.fit.fit.state);
    if let Some((node, bent)) = sprung(q, found, &plain.weights, plain.found.scale)? {
        let start = Start { bent, node, ..begin.clone() };
        plain = search(q, start, AT_FIRST, progress)?;
    }
    // What one line explains is no curve; it is weighed with everything else first.
    let Chosen { mut curves, mut lines, few } = plain.wanted(q);
    if !lines.is_empty() || !few.is_empty() {
        lines.extend(few.iter().flat_map(|few| few.lines.clone()));
        let start = Start { lines, ..plain.with_few(q, &few)? };
        plain = search(q, start, AT_FIRST, progress)?;
        curves = plain.wanted(q).curves;
    }
    if curves.is_empty() {
        let found = match plain.found.best.members.len() < FIRST.members {
            true => plain,
            // It went as far as it was let: farther.
            false => search(q, plain.again(), WHOLE, progress)?,
        };
        return replicated(q, found, progress)?.judged(q);
    }
    let (scale, refused, surely_refused) = (plain.found.scale, plain.refused, plain.surely_refused);
    let start = Start { curves, scale, refused, surely_refused, bent: plain.bent, ..begin };
    let first = search(q, start, AT_FIRST, progress)?;
    // At the noise that is left now, lengths and sizes are told better.
    let curves = first.wanted(q).curves;
    let mut again = Start { curves, ..first.again() };
    again.keep_tables();
    let mut found = replicated(q, search(q, again, WHOLE, progress)?, progress)?;
    loop {
        let mut less = found.again();
        let answer = found.judged(q)?;
        // Beside a joint that scatters what drew a curve may be nothing.
        let doubtful = |c: &Curve| {
            let is = |own: &Curved| usize::from(own.table.joint()) == c.joint && own.log_odds < 0.0;
            !answer.scattering.is_empty() && answer.curves.iter().any(is)
        };
        let all = less.curves.len();
        less.curves.retain(|c| !doubtful(c));
        if less.curves.len() == all {
            return Ok(answer);
        }
        less.keep_tables();
        found = replicated(q, search(q, less, WHOLE, progress)?, progress)?;
    }
}

/// A search from geometry and where it began: where evidence may have been lost to tails and
/// flags, with all rows alike.
fn from_geometry(q: &Question, root: &Node, progress: &dyn Fn()) -> Result<(Start, Searched)> {
    let start = Start::at(q, root);
    let found = search(q, start.clone(), AT_FIRST, progress)?;
    let Some(node) = swallowed::all_alike(q, root, &found) else { return Ok((start, found)) };
    let alike = Start { even: true, ..Start::at(q, &node) };
    Ok(match search(q, alike.clone(), AT_FIRST, progress) {
        Ok(other) if swallowed::is_better(q, &other, &found) => (alike, other),
        _ => (start, found),
    })
}

/// The same where joints may scatter by themselves, without lines that do not predict poses
/// held out of their scan; of their joints no other is looked for.
fn replicated(q: &Question, mut found: Searched, progress: &dyn Fn()) -> Result<Searched> {
    let mut dropped = Vec::new();
    loop {
        found = match (scattering::next(q, &found, &dropped), found.ended) {
            (Some(change), _) => {
                dropped.extend(change.dropped());
                search(q, scattering::after(q, &found, change)?, BESIDE_SCATTER, progress)?
            }
            (None, false) => search(q, found.again(), WHOLE, progress)?,
            (None, true) => break,
        };
    }
    for _ in 0..RESCANS {
        let ghosts = rescan::ghosts(q, &found);
        if ghosts.is_empty() {
            break;
        }
        let (out, kept): (Vec<Candidate>, Vec<Candidate>) =
            found.best.added.iter().cloned().partition(|c| ghosts.contains(c));
        let problem = found.bent.problem(q.problem);
        let mut start = found.again();
        start.node =
            fitted(&Question { problem: &problem, ..*q }, kept, &found.best.fit.fit.state)?;
        start.refused.extend(out);
        start.closed.extend(ghosts.iter().flat_map(|c| c.joints()).map(|joint| joint - 1));
        found = search(q, start, WHOLE, progress)?;
    }
    Ok(found)
}

/// Rounds of linearising, weighing and fitting until nothing changes.
fn search(q: &Question, start: Start, reach: Reach, progress: &dyn Fn()) -> Result<Searched> {
    let Start { mut node, curves, mut bent, mut scale, mut refused, lines, .. } = start;
    let Start { closed, scattering: mut scattered, even, mut nameless, mut surely_refused, .. } =
        start;
    let lambda = q.flags.lambda;
    let mut held = [lines::of(&node.added), lines].concat();
    let sources: Vec<Scatterer> = scattered.iter().map(|s| s.0).collect();
    let covered = q.problem.data.covered();
    let mut round = 0;
    loop {
        round += 1;
        bent.stand_at(&node.fit.fit.state);
        let problem = bent.problem(q.problem);
        let asked = Question { problem: &problem, ..*q };
        let (state, rows) = (node.fit.fit.state.clone(), node.fit.kept.clone());
        let mut weights =
            weights::after(&nameless::without(&problem, &state, &nameless), &node, &sources);
        if even && round == 1 {
            weights.rows.fill(1.0);
        }
        let mut possible =
            candidates(&asked, &node, &weights, (lambda, scale), (&held, &closed, &refused));
        possible.retain(|p| !p.is_within(&curves));
        let bending = bent.bending(&state);
        let sheet = Sheet::new(&problem, &state, &possible, &weights, &curves).bending(
            bending.clone(),
            &rows,
            lambda,
        );
        let precision = sheet.precision(lambda);
        let whole = sheet.gram(&rows);
        let entries: Vec<_> = possible.iter().map(|p| p.entry.clone()).collect();
        let known = (scale > 0.0).then(|| Known { members: members_of(&possible, &node), scale });
        let found = explain(&whole, &precision, &entries, reach.effort, known.as_ref());
        progress();
        let at = unbent::At {
            problem: &problem,
            state: &state,
            rows: &rows,
            weights: &weights,
            curves: &curves,
            possible: &possible,
            bending: bending.as_ref(),
            lambda,
        };
        let mut found = unbent::reweighed(&at, (&whole, &precision), found);
        scale = found.scale;
        let added = cloned(&possible, &found.best.members);
        let without_name = possible::nameless(&possible, &found);
        let beside = possible::same(&without_name, &nameless)
            && scattering::is_settled(&scattered, &weights.scattering);
        let same = beside && are(&added, &node.added);
        let still = beside && lines::are_still(&added, &node.added, &covered);
        nameless = without_name;
        scattered.clone_from(&weights.scattering);
        // What has a name is fitted without it, and rows that it moves far are no tails.
        let apart = nameless::without(q.problem, &state, &nameless);
        let apart = Question { problem: &apart, ..*q };
        held = lines::of(&added);
        let geometry = whole.geometry(&precision, scale);
        let all = Explained { q, possible: &possible, sheet: &sheet, precision: &precision };
        let solution = all.solution(&whole, &geometry, &found);
        let before = bent.clone();
        let mut next = bent.clone();
        next.find(&sheet, &solution, &geometry);
        // Beside curves, which have a prior that no fit of rows knows, a step at a time;
        // else moments begin where they were: with other members a whole step may lead away.
        let in_turn = curves.is_empty() && !sheet.moments(&solution).is_empty();
        bent = before.towards(&next, if in_turn { 0.0 } else { 1.0 });
        if in_turn {
            let with = With { weights: &weights, scale };
            (node, bent) = settled(&apart, &added, &state, bent, with)?;
        } else if !same || !curves.is_empty() {
            let problem = bent.problem(apart.problem);
            node = fitted(&Question { problem: &problem, ..*q }, added, &state)?;
        }
        let moved = bent.moved_from(&before);
        let problem = bent.problem(apart.problem);
        let asked = Question { problem: &problem, ..*q };
        let bad = impossible(&problem, &node);
        let again = !bad.is_empty() && round < reach.rounds + REFUSALS;
        if !bad.is_empty() {
            surely_refused.extend(probable(&bad, &possible, &found).cloned());
            found.leave_out(|m| possible[m].is(&bad));
            let kept = node.added.iter().filter(|c| !bad.contains(c)).cloned().collect();
            node = fitted(&asked, kept, &state)?;
            refused.extend(bad);
        }
        let settled = still && !moved;
        if !again && (settled || round >= reach.rounds) {
            drop(sheet);
            return Ok(Searched {
                ended: settled || reach.rounds >= WHOLE.rounds,
                best: node,
                curves,
                bent,
                state,
                held: before,
                rows,
                possible,
                weights,
                found,
                refused,
                surely_refused,
                closed,
            });
        }
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

/// Everything that is weighed in a round at a model: lines near those it had, and
/// what stands in for a refused one.
fn candidates(
    q: &Question,
    node: &Node,
    weights: &Weights,
    noise: (f64, f64),
    (held, closed, refused): (&[Held], &[usize], &[Candidate]),
) -> Vec<Possible> {
    let (state, rows) = (&node.fit.fit.state, &node.fit.kept);
    let mut numbers = Numbers::default();
    let mut out: Vec<Possible> =
        q.offered.iter().map(|candidate| numbers.offered(candidate.clone())).collect();
    out.extend(settling::near(&node.added, q.offered).map(|c| numbers.offered(c)));
    let late = late::near(q, node, weights, noise.1);
    out.extend(late.into_iter().map(|c| numbers.offered(c)));
    out.extend(lags::offered(q.problem, refused, &mut numbers));
    let columns = scan::columns(q.problem, state, rows, weights, noise, &scan::cell(q.problem));
    out.extend(lines::offered(state, &columns, q.highest_order, (held, closed), &mut numbers));
    out.extend(slips::offered(q.problem, rows, &columns, &mut numbers));
    out.extend(screen::offered(q.problem, rows, &columns, &mut numbers));
    let joints = revolute(q.problem);
    for (nameless, tried) in Nameless::all(q.problem, &joints, POLICY.wobbles) {
        out.push(numbers.nameless(nameless, tried));
    }
    out.retain(|p| !p.is(refused) && !lags::is_refused(p, refused));
    out
}

/// Members that a model can hold, for one.
fn cloned(possible: &[Possible], members: &[usize]) -> Vec<Candidate> {
    listed(possible, members).into_iter().cloned().collect()
}

/// Whether these are what a fitted model has.
fn are(members: &[Candidate], added: &[Candidate]) -> bool {
    members.len() == added.len() && members.iter().all(|m| added.iter().any(|a| a.terms == m.terms))
}

/// Which of the candidates a fitted model has.
fn members_of(possible: &[Possible], node: &Node) -> Vec<usize> {
    (0..possible.len()).filter(|k| possible[*k].is(&node.added)).collect()
}
