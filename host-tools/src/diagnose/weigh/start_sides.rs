//! On which side of its gap a joint rested before it first moved: where the order of the
//! rows tells the sides, nothing tells the first. In a session that moves one joint after
//! another that are most of the rows of the last one.

use nalgebra::{DMatrix, DVector, Vector3};

use super::sheet::{Sheet, Weights};
use super::slips;
use crate::error::Result;
use crate::identify::fit::robust::{Flags, robust_fit};
use crate::identify::problem::accumulate::{CHUNK, tree};
use crate::identify::{Problem, State};
use crate::model::Measurements;
use crate::model::arm::Derivatives;

/// Fewest poses before the first move of some joint: where all moved from the first pose on,
/// a side of that one alone is a bit for a single row.
const FEWEST: usize = 2;
/// Most joints of which all sides are tried together; others count as in the middle.
const MOST: usize = 10;
/// Of each diagonal entry, against joints whose gaps nobody could see.
const LEAST: f64 = 1e-9;

/// The measurements with the first side of each joint that waited, those that leave least if
/// every joint has a gap; `None` where none waited.
///
/// # Errors
/// When geometry cannot be fitted.
pub fn found(
    problem: &Problem,
    rows: &[usize],
    start: &State,
    flags: Flags,
) -> Result<Option<Measurements>> {
    let waiting = (0..problem.nominal.len()).map(|joint| (joint, waiting(problem, joint)));
    let waiting: Vec<Waiting> = waiting.filter(|(_, rows)| !rows.is_empty()).take(MOST).collect();
    if waiting.iter().all(|(_, rows)| poses(problem, rows) < FEWEST) {
        return Ok(None);
    }
    let fit = robust_fit(problem, rows, start, flags)?;
    let gaps = Gaps::of(problem, &fit.fit.state, &fit.kept, &waiting, flags.lambda);
    let sides = |choice: usize| move |k: usize| if choice >> k & 1 == 0 { 1_i8 } else { -1 };
    let best = (0..1_usize << waiting.len()).map(|choice| (choice, gaps.explained(&sides(choice))));
    let Some((best, _)) = best.max_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(None) };
    let mut out = problem.data.clone();
    for (k, (joint, waited)) in waiting.iter().enumerate() {
        for row in waited {
            let own = &mut out.rows[*row].directions;
            own.resize(problem.nominal.len(), 0);
            own[*joint] = sides(best)(k);
        }
    }
    Ok(Some(out))
}

/// A joint, counted from 0, and the rows before its first move.
type Waiting = (usize, Vec<usize>);

fn side(problem: &Problem, row: usize, joint: usize) -> i8 {
    problem.data.rows[row].directions.get(joint).copied().unwrap_or(0)
}

/// Rows before a joint's first move, where it moves at all.
fn waiting(problem: &Problem, joint: usize) -> Vec<usize> {
    let data = &problem.data;
    if !data.directions_from_order {
        return Vec::new();
    }
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let order = slips::in_order(problem, &rows).into_iter();
    let waited: Vec<usize> = order.take_while(|row| side(problem, *row, joint) == 0).collect();
    if waited.len() == rows.len() { Vec::new() } else { waited }
}

/// How often the arm stood elsewhere.
fn poses(problem: &Problem, rows: &[usize]) -> usize {
    let mut poses: Vec<usize> = rows.iter().map(|row| problem.data.rows[*row].pose).collect();
    poses.dedup();
    poses.len()
}

/// Normal equations of gaps, geometry projected off: those of all joints where their sides are
/// known, then of those that waited where they did.
struct Gaps {
    joints: usize,
    /// Joints that waited.
    waiting: Vec<usize>,
    normal: DMatrix<f64>,
    right: DVector<f64>,
}

impl Gaps {
    fn of(
        problem: &Problem,
        state: &State,
        rows: &[usize],
        waiting: &[Waiting],
        lambda: f64,
    ) -> Self {
        let at = problem.linearise(state);
        let joints = problem.nominal.len();
        let moved =
            |joint: usize, d: &Derivatives| *d.links[joint].joint(problem.nominal[joint].kind);
        let mut waits = vec![vec![false; problem.data.rows.len()]; waiting.len()];
        for (own, (_, rows)) in waits.iter_mut().zip(waiting) {
            rows.iter().for_each(|row| own[*row] = true);
        }
        let beside = |row: usize, d: &Derivatives| {
            let known = (0..joints).map(|j| moved(j, d) * f64::from(side(problem, row, j)));
            let waited = waiting.iter().zip(&waits).map(|((joint, _), waits)| {
                if waits[row] { moved(*joint, d) } else { Vector3::zeros() }
            });
            known.chain(waited).collect::<Vec<_>>()
        };
        let leaf = |own: &[usize]| {
            let of = |row: &usize| {
                let e = at.equations_beside(*row, &beside);
                let right = e.block.tr_mul(&e.scaled_residual().column());
                (e.block.tr_mul(&e.block), DVector::from_column_slice(right.as_slice()))
            };
            own.iter().map(of).reduce(|a, b| (a.0 + b.0, a.1 + b.1)).unwrap_or_default()
        };
        let (sums, right) = tree(rows, CHUNK, &leaf, &|a, b| (a.0 + b.0, a.1 + b.1));
        let rigid = problem.unknowns.list().len();
        let gaps = joints + waiting.len();
        let weights = Weights::alike(problem.data.rows.len());
        let precision = Sheet::new(problem, state, &[], &weights, &[]).precision(lambda);
        let geometry = sums.view((0, 0), (rigid, rigid)).into_owned()
            + DMatrix::from_diagonal(&precision.rows(0, rigid).into_owned());
        let both = sums.view((0, rigid), (rigid, gaps)).into_owned();
        let mut out = Self {
            joints,
            waiting: waiting.iter().map(|(joint, _)| *joint).collect(),
            normal: sums.view((rigid, rigid), (gaps, gaps)).into_owned(),
            right: right.rows(rigid, gaps).into_owned(),
        };
        if let Some(factor) = geometry.cholesky() {
            out.normal -= both.tr_mul(&factor.solve(&both));
            out.right -= both.tr_mul(&factor.solve(&right.rows(0, rigid).into_owned()));
        }
        out
    }

    /// Fall of the sum of squares with these first sides.
    fn explained(&self, side: &dyn Fn(usize) -> i8) -> f64 {
        let mut joined = DMatrix::zeros(self.joints + self.waiting.len(), self.joints);
        (0..self.joints).for_each(|joint| joined[(joint, joint)] = 1.0);
        for (k, joint) in self.waiting.iter().enumerate() {
            joined[(self.joints + k, *joint)] = f64::from(side(k));
        }
        let mut normal = joined.tr_mul(&self.normal) * &joined;
        let right = joined.tr_mul(&self.right);
        // Of a joint whose gap nobody can see nothing is left but rounding.
        let most = normal.diagonal().max().max(f64::MIN_POSITIVE);
        for joint in 0..self.joints {
            normal[(joint, joint)] += LEAST * most;
        }
        normal.cholesky().map_or(0.0, |factor| right.dot(&factor.solve(&right)))
    }
}
