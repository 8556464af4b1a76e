//! What people compare before they buy, and how much of it they need.

use rayon::prelude::*;
use truearm_host::model::{KindId, Robot};
use truearm_host::observations::KINDS;
use truearm_host::tikhonov::covariance;

use crate::judged::{once, solved};

/// So many of each kind.
pub type Wanted = [(&'static str, usize)];

/// What is measured, in words and as the simulator counts it.
pub const CASES: [(&str, &Wanted); 9] = [
    ("50 tracker points", &[("point", 50)]),
    ("50 full poses", &[("pose", 50)]),
    ("200 ballbar lengths, three feet", &[("distance", 200)]),
    ("200 distances between two poses", &[("pair", 200)]),
    ("150 touches of three planes", &[("touch", 150)]),
    ("100 holes of a plate", &[("plate", 100)]),
    ("150 ranges to three planes", &[("range", 150)]),
    ("90 closures at three points", &[("closure", 90)]),
    ("60 images of a board", &[("pixel", 60)]),
];

/// The other forms of surfaces, and the kind that says nothing of lengths: for
/// bounds and intervals, not for a comparison.
pub const OTHERS: [(&str, &Wanted); 3] = [
    ("60 touches of planes, 60 of a sphere", &[("touch", 60), ("sphere", 60)]),
    ("150 touches of a cylinder", &[("cylinder", 150)]),
    ("100 inclinations, 60 ballbar lengths", &[("inclination", 100), ("distance", 60)]),
];

/// Tool error that is asked for, m.
pub(super) const GOAL: f64 = 1e-4;
/// Arms by which the number for it is judged: none of those that the table judges.
const FEW: u64 = 12;
pub(super) const OF_THEIR_OWN: u64 = 1000;
/// Quarters of an octave about the number of a case.
const STEPS: i32 = 16;
/// A combination of parameters known no better than this share of its tolerance is
/// left to the tolerances.
const OPEN: f64 = 0.9;

/// The fewest of a kind, by the bound, for the goal: to a quarter of an octave,
/// in at most 16 times as many as the case has.
#[must_use]
pub fn needed(robot: &Robot, wanted: &Wanted) -> Option<usize> {
    let (kind, count) = wanted[0];
    let of = |step: i32| (count as f64 * 2_f64.powf(f64::from(step) / 4.0)).round() as usize;
    let reached = |step: i32| {
        let bound = |seed| once(robot, &[(kind, of(step))], OF_THEIR_OWN + seed);
        // Too few to say anything are too few.
        let bounds = (0..FEW).into_par_iter().map(|s| bound(s).map_or(f64::INFINITY, |x| x[1]));
        (bounds.sum::<f64>() / FEW as f64).sqrt() <= GOAL
    };
    let (mut below, mut enough) = (-STEPS - 1, STEPS);
    if !reached(enough) {
        return None;
    }
    while enough - below > 1 {
        let middle = i32::midpoint(below, enough);
        *(if reached(middle) { &mut enough } else { &mut below }) = middle;
    }
    Some(of(enough))
}

/// How many combinations of link parameters a kind says nothing of, beyond the
/// tolerances, and what it leaves open in words: of one arm.
#[must_use]
pub fn open(robot: &Robot, wanted: &Wanted) -> (usize, String) {
    let of = solved(robot, wanted, OF_THEIR_OWN, |solved, _| {
        let free = solved.problem.unknowns.free();
        let known = covariance(&solved.found.fit.normal, free, 1.0);
        let count = known.nrows() - free;
        let links = known.view((free, free), (count, count)).into_owned();
        let sizes = links.symmetric_eigenvalues();
        let open = sizes.iter().filter(|square| square.sqrt() > OPEN).count();
        let mut kinds: Vec<KindId> = solved.problem.data.rows.iter().map(|r| r.kind).collect();
        kinds.dedup();
        let words = kinds.iter().map(|kind| KINDS[usize::from(kind.0)].leaves());
        (open, words.collect::<Vec<_>>().join(" / "))
    });
    of.unwrap_or_else(|error| panic!("{wanted:?}: {error}"))
}
