//! How late an arm follows its temperature: the time constant of the model, where the
//! evidence of all that it has beside it is highest, is a candidate in the next round, as
//! the orders of lines are.

use truearm::effects::Order;

use super::possible::Numbers;
use super::sheet::{Sheet, Weights};
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::Node;
use crate::diagnose::question::Question;
use crate::evidence::Subsets;

/// How far to either side time constants are looked at, as a logarithm: to the next ones
/// that are offered; and in how many steps.
const AROUND: f64 = 0.7;
const STEPS: i32 = 7;
/// A time constant that is less far from the best is the best, as a logarithm: an hour's
/// session tells none to a tenth of that.
const SETTLED: f64 = 0.01;

/// What goes late with the temperature in a fitted model, with its own and with the best time
/// constant, but for what is offered anyway.
pub fn near(q: &Question, node: &Node, weights: &Weights, scale: f64) -> Vec<Candidate> {
    let tau = node.added.iter().map(Candidate::time_constant).fold(0.0, f64::max);
    if tau == 0.0 || scale <= 0.0 {
        return Vec::new();
    }
    let best = best(q, node, weights, scale);
    let late = node.added.iter().filter(|c| c.time_constant() > 0.0);
    let both = late.flat_map(|c| [c.late(tau), c.late(best)]);
    let mut out: Vec<Candidate> = both.collect();
    out.dedup_by(|a, b| a.terms == b.terms);
    out.retain(|c| q.offered.iter().all(|other| other.terms != c.terms));
    out
}

/// The time constant at which the evidence is highest, as a blob holds it; that of the model
/// where it is next to it.
fn best(q: &Question, node: &Node, weights: &Weights, scale: f64) -> f64 {
    let (late, others): (Vec<&Candidate>, Vec<_>) =
        node.added.iter().partition(|c| c.time_constant() > 0.0);
    let tau = late.iter().map(|c| c.time_constant()).fold(0.0, f64::max);
    let step = AROUND / f64::from(STEPS);
    let tried: Vec<f64> = (-STEPS..=STEPS)
        .map(|k| if k == 0 { tau } else { tau * (step * f64::from(k)).exp() })
        .collect();
    let mut numbers = Numbers::default();
    let mut possible: Vec<_> = others.iter().map(|c| numbers.offered((*c).clone())).collect();
    for tau in &tried {
        possible.extend(late.iter().map(|c| numbers.offered(c.late(*tau))));
    }
    let entries = possible.iter().map(|p| p.entry.clone()).collect();
    let sheet = Sheet::new(q.problem, &node.fit.fit.state, &possible, weights, &[]);
    let gram = sheet.gram(&node.fit.kept);
    let geometry = gram.geometry(&sheet.precision(q.flags.lambda), scale);
    let subsets = Subsets::new(gram.project(&geometry), entries);
    let at = |k: usize| {
        let first = others.len() + k * late.len();
        let members: Vec<usize> = (0..others.len()).chain(first..first + late.len()).collect();
        subsets.fit(&members, &|_| None).log_mass
    };
    let heights: Vec<f64> = (0..tried.len()).map(at).collect();
    let top = heights.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(k, _)| k);
    let off = match (top.checked_sub(1).map(|k| heights[k]), heights.get(top + 1)) {
        // The top of a parabola through three points.
        (Some(low), Some(high)) => {
            let bend = low + high - 2.0 * heights[top];
            if bend < 0.0 { (low - high) / (2.0 * bend) } else { 0.0 }
        }
        _ => 0.0,
    };
    let best = held(tried[top] * (step * off).exp());
    if (best / tau).ln().abs() < SETTLED { tau } else { best }
}

/// As a blob holds it, s.
fn held(time_constant: f64) -> f64 {
    let step = Order::TimeConstant.step(0.0);
    step * (time_constant / step).round().max(1.0)
}
