//! A part of the cell that errs as something recorded goes: every part with every
//! covariate that no effect of the repertoire takes, each as a few smooth functions. All
//! are scanned alone; what explains most is weighed with everything else.

mod covariate;
mod part;
mod smooth;

use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

use super::nameless::Nameless;
use super::possible::{Numbers, Possible};
use super::scan::Columns;
use crate::diagnose::policy::POLICY;
use crate::evidence::lines::JointColumn;
use crate::identify::Problem;
use crate::model::arm::Derivatives;
use crate::observations::{kind, postures};
pub use covariate::Covariate;
pub use part::Part;
pub use smooth::{Shape, Smooth};

/// A part that errs with a covariate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follows {
    /// What errs.
    pub part: Part,
    /// With what.
    pub with: Covariate,
    /// How.
    pub how: Smooth,
}

/// Numbers of covariates at most: of kinds, and of joints.
const COVARIATES: usize = 32;

impl Follows {
    /// How the target of a row moves with each coefficient, SI: way after way.
    #[must_use]
    pub fn columns(&self, problem: &Problem, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        // Of rows that have none, nothing: all have it, or it is not looked at.
        let at = self.with.at(problem, index).map(|value| self.how.at(value));
        let at = at.unwrap_or_else(|| vec![0.0; self.how.shape.count()]);
        let moves = self.part.moves(problem, d);
        moves.iter().flat_map(|way| at.iter().map(move |f| way * *f)).collect()
    }

    /// How many columns.
    #[must_use]
    pub fn count(&self) -> usize {
        self.part.ways() * self.how.shape.count()
    }

    /// A number for the pair.
    #[must_use]
    pub fn number(&self) -> usize {
        self.part.number() * COVARIATES + self.with.number()
    }

    /// What it says.
    #[must_use]
    pub fn words(&self, problem: &Problem) -> String {
        format!("{} as {} goes", self.part.words(), self.with.words(problem))
    }
}

/// Whether the repertoire has what a part does with a covariate, or geometry and something
/// else together do.
fn has_name(part: Part, with: Covariate) -> bool {
    match (part, with) {
        // Curves, lines, and of a joint that slides its gain.
        (Part::Joint(joint), Covariate::Joint(other)) => joint == other,
        // Where the joints stand is where the target is.
        (Part::Joint(_), Covariate::Azimuth | Covariate::Elevation | Covariate::Distance) => true,
        (
            Part::Lean | Part::Shift | Part::Target,
            Covariate::Azimuth | Covariate::Elevation | Covariate::Distance,
        ) => true,
        // Springs.
        (Part::Lean | Part::Shift, Covariate::Payload) => true,
        (Part::Azimuth | Part::Elevation | Part::Distance, Covariate::Joint(_)) => true,
        (Part::Azimuth | Part::Elevation | Part::Distance, Covariate::Payload) => true,
        _ => false,
    }
}

/// All pairs that the rows can tell, with how many of the part there are.
#[must_use]
pub fn pairs(problem: &Problem, rows: &[usize]) -> Vec<(Follows, usize)> {
    let data = &problem.data.rows;
    let seen = data.iter().all(|row| kind(row).point(row).is_some());
    let recorded = Covariate::recorded(problem).into_iter().filter_map(|with| {
        let mut values: Vec<f64> = rows.iter().filter_map(|r| with.at(problem, *r)).collect();
        values.sort_by(f64::total_cmp);
        let range = [*values.first()?, *values.last()?];
        let near = (range[1] - range[0]) * LEVEL;
        values.dedup_by(|a, b| *a - *b <= near);
        Some((with, range, Shape::all(with.turns(problem), range, values.len())))
    });
    let recorded: Vec<_> = recorded.collect();
    let of_part = |part: Part| {
        let with = recorded.iter().filter(move |(with, ..)| !has_name(part, *with));
        with.flat_map(move |(with, range, shapes)| {
            let how = |shape: &Shape| Smooth { range: *range, shape: *shape };
            shapes.iter().map(move |s| Follows { part, with: *with, how: how(s) })
        })
    };
    let all: Vec<Follows> =
        Part::all(problem.nominal.len(), seen).flat_map(of_part).filter(is_offered).collect();
    let tried = |f: &Follows| all.iter().filter(|o| o.part.number() == f.part.number()).count();
    all.iter().map(|f| (*f, tried(f))).collect()
}

/// Values nearer to each other than this share of the range are one.
const LEVEL: f64 = 1e-3;

/// A share of another joint's angle has a name.
fn is_offered(f: &Follows) -> bool {
    let coupled = matches!((f.part, f.with), (Part::Joint(_), Covariate::Joint(_)));
    !(coupled && f.how.shape == Shape::Bow(1))
}

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
    let rate = |(follows, tried): &(Follows, usize)| {
        let value = |k: usize| follows.with.at(problem, postures[k]);
        let functions: Option<Vec<(usize, Vec<f64>)>> = (0..postures.len())
            .step_by(every)
            .map(|k| Some((k, follows.how.at(value(k)?))))
            .collect();
        let functions = functions?;
        let ways = columns.of(follows.part);
        let gain: f64 = ways.iter().map(|way| explained(way, &functions, every as f64)).sum();
        let odds = log_odds(gain, follows.count() as f64) - (*tried as f64).ln();
        Some((odds, *follows, *tried))
    };
    let pairs = pairs(problem, rows);
    let mut rated: Vec<_> = pairs.par_iter().filter_map(rate).collect();
    rated.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut out: Vec<(Follows, usize)> = Vec::new();
    for (odds, follows, tried) in rated {
        let same =
            |o: &&(Follows, usize)| o.0.number() == follows.number() && o.0.part == follows.part;
        if odds > 0.0 && out.iter().filter(same).count() < OF_A_PAIR {
            out.push((follows, tried));
        }
        if out.len() == POLICY.screened {
            break;
        }
    }
    out.into_iter().map(|(f, tried)| numbers.nameless(Nameless::Follows(f), tried)).collect()
}

/// Postures that pairs are ranked by, at least.
const LOOKS: usize = 3000;

/// Share of a column's square that geometry must not imitate.
const SEEN: f64 = 1e-4;

/// Courses of one pair that are weighed.
const OF_A_PAIR: usize = 2;

/// Fall of the weighted sum of squares by functions along a way, geometry projected off.
fn explained(way: &JointColumn, functions: &[(usize, Vec<f64>)], every: f64) -> f64 {
    let (p, c) = (way.imitated.nrows(), functions.first().map_or(0, |f| f.1.len()));
    let (mut square, mut right) = (DMatrix::zeros(c, c), DVector::zeros(c));
    let mut imitated = DMatrix::zeros(p, c);
    for (k, f) in functions {
        let f = DVector::from_column_slice(f);
        square.ger(way.square[*k] * every, &f, &f, 1.0);
        right.axpy(way.right[*k] * every, &f, 1.0);
        imitated.ger(every, &way.imitated.column(*k), &f, 1.0);
    }
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
