//! Explanations by how probable they are, and which of them is believed.

use super::mistake::Mistake;
use super::search::{Found, Search};

/// An explanation must be this much more probable than a simpler one, nats.
const CLEARLY: f64 = 12.0;
/// Explanations within this of the best one are as good, nats.
const AS_GOOD: f64 = 6.0;
/// A fit that leaves less, m, and corrects by less, tolerances, asks for no
/// second mistake.
const GOOD: (f64, f64) = (2e-3, 12.0);
/// A misfit beyond makes no sense, m: no arm and no effect is that far off...
pub(super) const SENSELESS: f64 = 0.02;
/// ...nor so far where a coordinate is known so many times better: half of the rows may be
/// another arm's, or another target's, and the fit then lies between the two.
const FAR_FOR_THE_NOISE: (f64, f64) = (5e-3, 50.0);
/// The same over how far the points are spread: an explanation must explain
/// them, not make the arm small.
const EXPLAINED: f64 = 0.05;
/// Corrections beyond are no arm's own, tolerances.
pub(super) const UNBELIEVABLE: f64 = 100.0;

/// Explanations by how probable they are.
pub(super) struct Ranked {
    pub best: Found,
    pub all: Vec<Found>,
    /// Points in another unit fit as well.
    pub unit_is_unseen: bool,
}

/// The best explanation, and all by how probable they are. One that changes a
/// file wins over a fit of the files as they are only where that rests, begun from
/// its own place as well.
pub(super) fn ranked(search: &Search, nothing: &mut Found) -> Ranked {
    let mut ones = search.one();
    // Of an arm without lengths points in another unit are those of a larger tool: where one is
    // no worse than the files as they are, and no better, none is believed.
    let mut unit_is_unseen = false;
    if nothing.fitted.is_finest() {
        let is_unit = |one: &Found| one.changes.iter().any(|c| matches!(c, Mistake::PointUnit(_)));
        let (units, others): (Vec<Found>, Vec<Found>) = ones.into_iter().partition(is_unit);
        let gains: Vec<f64> = units.iter().map(|one| search.worse_by(nothing, one)).collect();
        unit_is_unseen = gains.iter().any(|gain| gain.abs() < CLEARLY);
        let better = units.into_iter().zip(gains).filter(|(_, gain)| *gain >= CLEARLY);
        let better = better.map(|(one, _)| one).filter(|_| !unit_is_unseen);
        ones = others.into_iter().chain(better).collect();
        ones.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    }
    if let Some(one) = ones.first().filter(|one| nothing.cost - one.cost >= CLEARLY) {
        let again = search.nothing_from(one);
        if again.cost < nothing.cost {
            *nothing = again;
        }
    }
    let mut best = better(nothing.clone(), ones.first());
    let mut ranked = ones.clone();
    if !good(&best) {
        let twos = search.two(&ones);
        best = better(best, twos.first());
        ranked.extend(twos);
    }
    ranked.push(nothing.clone());
    ranked.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Ranked { best, all: ranked, unit_is_unseen }
}

/// Explanations beside the best one.
#[derive(Default)]
pub(super) struct Others<'a> {
    /// As good as it is.
    pub equivalent: Vec<&'a Found>,
    /// The next one.
    pub next: Option<&'a Found>,
}

/// Of ranked explanations. The same number found from another start is no
/// other one.
pub(super) fn others<'a>(best: &Found, ranked: &'a [Found]) -> Others<'a> {
    let same = |a: &Found, b: &Found| {
        a.changes.len() == b.changes.len()
            && a.changes.iter().all(|a| {
                b.changes.iter().any(|b| match (a, b) {
                    (Mistake::Value(..), Mistake::Value(..)) => a.same_place(b),
                    _ => a == b,
                })
            })
    };
    let mut found = Others::default();
    for other in ranked.iter().filter(|other| !same(other, best)) {
        if other.cost - best.cost >= AS_GOOD {
            found.next = Some(other);
            break;
        }
        let known = found.equivalent.iter().any(|known| same(known, other));
        if !known && other.changes.len() <= best.changes.len() {
            found.equivalent.push(other);
        }
    }
    found
}

/// The other if it is clearly more probable.
fn better(simple: Found, other: Option<&Found>) -> Found {
    match other {
        Some(other) if simple.cost - other.cost >= CLEARLY && explains(other) => other.clone(),
        _ => simple,
    }
}

fn good(found: &Found) -> bool {
    found.fitted.spread <= GOOD.0 && found.fitted.correction <= GOOD.1 && explains(found)
}

fn explains(found: &Found) -> bool {
    !senseless(found) && found.fitted.rms <= EXPLAINED * found.fitted.extent
}

/// Whether no arm and no effect is so far off.
pub(super) fn senseless(found: &Found) -> bool {
    let (least, sigmas) = FAR_FOR_THE_NOISE;
    let most = (sigmas * found.fitted.sigma).clamp(least, SENSELESS);
    found.fitted.rms > most || found.fitted.correction > UNBELIEVABLE
}
