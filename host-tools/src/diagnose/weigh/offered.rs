//! All that is weighed in a round at a model.

use super::lines::{self, Held};
use super::nameless::{self, Nameless};
use super::possible::{Numbers, Possible, revolute};
use super::sheet::Weights;
use super::{lags, late, scan, screen, settling, slips};
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::Node;
use crate::diagnose::policy::POLICY;
use crate::diagnose::question::Question;

/// Candidates of known form, lines near those that the model had, and what stands in for a
/// refused one.
///
/// What comes and goes is looked for with the steps that were found in the rows and without them:
/// each course is scanned alone, and what imitates half of a step a little explained more than all
/// that is there beside it (of 25 arms that somebody else gave a step and a joint that is off with
/// another one 17 lost the second); and a step that is none must not hide what it imitates.
pub fn offered(
    q: &Question,
    without: &[nameless::Held],
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
    let cell = scan::cell(q.problem);
    let columns = scan::columns(q.problem, state, rows, weights, noise, &cell);
    out.extend(lines::offered(state, &columns, q.highest_order, (held, closed), &mut numbers));
    out.extend(screen::offered(q.problem, rows, &columns, &mut numbers));
    let mut stepping = slips::offered(q.problem, rows, &columns);
    let steps: Vec<_> = without.iter().filter(|(what, _)| what.is_step()).cloned().collect();
    if !steps.is_empty() {
        let apart = nameless::without(q.problem, state, &steps);
        let beside = scan::columns(&apart, state, rows, weights, noise, &cell);
        for course in screen::offered(q.problem, rows, &beside, &mut numbers) {
            if !out.iter().any(|other| other.what == course.what) {
                out.push(course);
            }
        }
        stepping.extend(steps.iter().map(|(what, _)| *what));
        stepping.extend(slips::offered(q.problem, rows, &beside));
    }
    for (k, step) in stepping.iter().enumerate() {
        if !stepping[..k].contains(step) {
            out.push(numbers.nameless(*step, slips::tried(&columns, rows, step)));
        }
    }
    let joints = revolute(q.problem);
    for (nameless, tried) in Nameless::all(q.problem, &joints, POLICY.wobbles) {
        out.push(numbers.nameless(nameless, tried));
    }
    out.retain(|p| !p.is(refused) && !lags::is_refused(p, refused));
    out
}
