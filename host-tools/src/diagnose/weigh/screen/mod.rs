//! Every part of the cell with every covariate that no effect of the repertoire takes, each
//! as a few smooth functions. All are scanned alone; what explains most is weighed with
//! everything else.

#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::follows::{Covariate, Follows, Part, Shape, Smooth, smooth};
use super::nameless::Nameless;
use super::possible::{Numbers, Possible};
use super::scan::Columns;
use crate::diagnose::policy::POLICY;
use crate::evidence::lines::JointColumn;
use crate::identify::Problem;
use crate::observations::postures;

/// Whether the repertoire has what a part does with a covariate, or geometry and something
/// else together do.
fn has_name(problem: &Problem, part: Part, with: Covariate, shape: Shape) -> bool {
    let straight = shape == Shape::Bow(1);
    match (part, with) {
        // What is measured against errs with where it is touched, with what is measured, or
        // with time.
        (Part::Surface(k), Covariate::Place(axis)) => {
            straight && part.has_slope(problem) || !problem.cell.lies_on(k, axis)
        }
        (
            Part::Length(_),
            Covariate::Length | Covariate::Time | Covariate::Order | Covariate::Temperature,
        ) => false,
        (Part::Surface(_) | Part::Length(_), _) | (_, Covariate::Place(_) | Covariate::Length) => {
            true
        }
        // Curves, lines, and of a joint that slides its gain; a share is a coupling.
        (Part::Joint(joint), Covariate::Joint(other)) => joint == other || straight,
        // It creeps.
        (Part::Joint(_), Covariate::Time) => straight,
        // Where the joints stand is where the target is.
        (
            Part::Joint(_) | Part::Lean | Part::Shift | Part::Target,
            Covariate::Azimuth | Covariate::Elevation | Covariate::Distance,
        ) => true,
        // The axis of the first joint tilts.
        (Part::Lean, Covariate::Joint(0)) if with.turns(problem) => true,
        // It gives way under what follows a joint, heavier than its masses say.
        (Part::Lean, Covariate::Joint(_)) if shape == Shape::Wave(1) => true,
        // A drift, which settles in a time that is found only once there is one. An instrument
        // that turns as time goes is one, whatever it turns about.
        (
            Part::Lean | Part::Shift | Part::Azimuth | Part::Elevation,
            Covariate::Time | Covariate::Order,
        ) => true,
        // Springs.
        (Part::Lean | Part::Shift, Covariate::Payload) => true,
        (Part::Azimuth | Part::Elevation | Part::Distance, Covariate::Joint(_)) => true,
        (Part::Azimuth | Part::Elevation | Part::Distance, Covariate::Payload) => true,
        _ => false,
    }
}

/// As many ways more to do what a drift all but does: where the flange keeps its orientation a
/// target that creeps on it is one, and in a session that only warms up so is what goes with the
/// temperature. At 1 drifts of 1.8 to 2.4 floors over cubes of poses in one orientation, in arms
/// that somebody else made, were shared out among such neighbours until none had a name.
const BESIDE_DRIFT: usize = 10;

/// How many ways the price of a pair counts for each there is.
fn ways(problem: &Problem, follows: &Follows) -> usize {
    let drifts = problem.conditions.time || problem.conditions.ordered;
    let of_arm = matches!(follows.part, Part::Joint(_));
    let as_time_goes =
        matches!(follows.with, Covariate::Time | Covariate::Order | Covariate::Temperature);
    if drifts && as_time_goes && !of_arm { BESIDE_DRIFT } else { 1 }
}

/// Whether a joint's zero goes in proportion to the temperature: as one that wanders with time it
/// has the prior of a kind of its own. Split among all that a joint may follow it had far less,
/// and of nine arms that somebody else made so seven were said to wander with time.
fn is_warmth(follows: &Follows) -> bool {
    let straight = follows.how.shape == Shape::Bow(1);
    matches!(follows.part, Part::Joint(_)) && straight && follows.with == Covariate::Temperature
}

/// All pairs that the rows can tell, with how many of the part there are.
#[must_use]
pub fn pairs(problem: &Problem, rows: &[usize]) -> Vec<(Follows, usize)> {
    let recorded = Covariate::recorded(problem).into_iter().filter_map(|with| {
        let mut values: Vec<f64> = rows.iter().filter_map(|r| with.at(problem, *r)).collect();
        let range = smooth::range(&mut values, with == Covariate::Azimuth)?;
        let near = (range[1] - range[0]) * LEVEL;
        values.dedup_by(|a, b| *a - *b <= near);
        // Of two payloads each is told by many rows.
        let levels = values.len() + usize::from(with == Covariate::Payload);
        Some((with, range, Shape::all(with.turns(problem), range, levels)))
    });
    let recorded: Vec<_> = recorded.collect();
    let of_part = |part: Part| {
        let of = move |(with, range, shapes): &(Covariate, [f64; 2], Vec<Shape>)| {
            let shapes = shapes.iter().filter(|s| !has_name(problem, part, *with, **s));
            let how = |shape: &Shape| Smooth { range: *range, shape: *shape };
            shapes.map(|s| Follows { part, with: *with, how: how(s) }).collect::<Vec<_>>()
        };
        recorded.iter().flat_map(of)
    };
    let seen = recorded.iter().any(|(with, ..)| *with == Covariate::Distance);
    let all: Vec<Follows> = Part::all(problem, seen).flat_map(of_part).collect();
    let tried = |f: &Follows| match is_warmth(f) {
        true => problem.nominal.len(),
        false => all.iter().filter(|o| o.part.number() == f.part.number()).count(),
    };
    all.iter().map(|f| (*f, tried(f) * ways(problem, f))).collect()
}

/// Values nearer to each other than this share of the range are one.
const LEVEL: f64 = 1e-3;

/// Those that explain most alone, as candidates.
pub fn offered(
    problem: &Problem,
    rows: &[usize],
    columns: &Columns,
    numbers: &mut Numbers,
) -> Vec<Possible> {
    let postures = postures(&problem.data.rows, rows);
    // To rank pairs, some thousands say as much as all.
    let every = postures.len().div_ceil(LOOKS).max(1);
    let looked: Vec<usize> = (0..postures.len()).step_by(every).collect();
    let pairs = pairs(problem, rows);
    // The same functions of every part: with the columns of ways only products are left.
    let mut courses: Vec<(Covariate, Smooth)> = pairs.iter().map(|p| (p.0.with, p.0.how)).collect();
    let number = |c: &(Covariate, Smooth)| (c.0.number(), c.1.shape.number());
    courses.sort_by_key(number);
    courses.dedup_by_key(|c| number(c));
    let at = |(with, how): &(Covariate, Smooth)| {
        let count = how.shape.count();
        let mut functions = DMatrix::zeros(looked.len(), count);
        for (mut row, k) in functions.row_iter_mut().zip(&looked) {
            if let Some(value) = with.within(problem, postures[*k], how.range) {
                row.copy_from_slice(&how.at(value));
            }
        }
        functions
    };
    let functions: Vec<DMatrix<f64>> = courses.par_iter().map(at).collect();
    let of_looked = |part: Part| (part, columns.ways(part).map(|way| way.column(every)).collect());
    let parts: Vec<(Part, Vec<JointColumn>)> = Part::all(problem, true).map(of_looked).collect();
    let rate = |(follows, tried): &(Follows, usize)| {
        let own = courses.iter().position(|c| number(c) == number(&(follows.with, follows.how)))?;
        let (_, ways) = parts.iter().find(|(part, _)| *part == follows.part)?;
        let gain: f64 = ways.iter().map(|way| explained(way, &functions[own], every as f64)).sum();
        let odds = log_odds(gain, follows.count() as f64) - (*tried as f64).ln();
        Some((odds, *follows, *tried))
    };
    let mut rated: Vec<_> = pairs.par_iter().filter_map(rate).collect();
    rated.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut out: Vec<(Follows, usize)> = Vec::new();
    let mut room = COLUMNS;
    for (odds, follows, tried) in rated {
        let same =
            |o: &&(Follows, usize)| o.0.number() == follows.number() && o.0.part == follows.part;
        let fits = odds > 0.0 && follows.count() <= room;
        if fits && out.iter().filter(same).count() < OF_A_PAIR {
            room -= follows.count();
            out.push((follows, tried));
        }
        if out.len() == POLICY.screened {
            break;
        }
    }
    out.into_iter().map(|(f, tried)| numbers.nameless(Nameless::Follows(f), tried)).collect()
}

/// Postures that pairs are ranked by, at most.
const LOOKS: usize = 3000;

/// Columns that are weighed with everything else, at most: every one of them costs a product
/// with all others a row.
const COLUMNS: usize = 60;

/// Share of a column's square that geometry must not imitate.
const SEEN: f64 = 1e-4;

/// Courses of one pair that are weighed.
const OF_A_PAIR: usize = 2;

/// Fall of the weighted sum of squares by functions along a way, a row a posture, each of
/// which stands for so many; geometry projected off.
fn explained(way: &JointColumn, functions: &DMatrix<f64>, every: f64) -> f64 {
    let mut weighted = functions.clone();
    for (mut row, square) in weighted.row_iter_mut().zip(&way.square) {
        row *= square * every;
    }
    let square = functions.tr_mul(&weighted);
    let right = functions.tr_mul(&DVector::from_column_slice(&way.right)) * every;
    let imitated = &way.imitated * functions * every;
    // What geometry imitates is held.
    let held = DMatrix::from_diagonal(&square.diagonal()) * SEEN;
    let left = square - imitated.tr_mul(&imitated) + held;
    left.cholesky().map_or(0.0, |factor| right.dot(&factor.solve(&right)))
}

/// Log odds of `count` columns that explain so much, at the prior size that suits them best
/// (local empirical Bayes, Liang et al. 2008).
fn log_odds(explained: f64, count: f64) -> f64 {
    match explained > count {
        true => (explained - count - count * (explained / count).ln()) / 2.0,
        false => 0.0,
    }
}
