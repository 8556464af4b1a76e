//! What the data cannot determine: rank, condition number, and the redundant
//! directions in words.

use nalgebra::DMatrix;

use crate::identify::problem::{Problem, Scaling, State, Unknown};
use crate::model::Values;

/// Singular values below this share of the largest are zero: structural
/// redundancy gives 1e-16, the weakest real direction of an arm about 1e-6.
const ZERO: f64 = 1e-10;
/// Share of a direction below which a parameter is not worth naming.
const NAMED: f64 = 0.02;

/// Identifiability of a data set, at nominal geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Redundancy {
    /// Independent directions among all unknowns.
    pub rank: usize,
    /// Largest over smallest non-zero singular value, columns in tolerances.
    pub condition: f64,
    /// Eq. 24 of the paper: of the link columns in metres and radians,
    /// redundant ones included; infinite at rounding level.
    pub condition_raw: f64,
    /// Combinations of parameters that move no measured point, in words.
    pub redundant: Vec<String>,
    /// Directions about which the data say less than the tolerances, in words.
    pub weak: Vec<String>,
}

/// Analyses all `rows` with nominal links at the bases and markers of `state`.
#[must_use]
pub fn analyse(problem: &Problem, state: &State, rows: &[usize]) -> Redundancy {
    let nominal = State { links: problem.nominal.clone(), ..state.clone() };
    let scaled = Problem { scaling: Scaling::Prior, ..problem.clone() };
    let matrix = scaled.linearise(&nominal).triangle(rows, None).matrix();
    let raw = raw(&scaled, &nominal, rows, &matrix);
    let svd = matrix.svd(false, true);
    let v_t = svd.v_t.unwrap_or_default();
    let s = &svd.singular_values;
    let zero = ZERO * s[0];
    let rank = s.iter().filter(|s| **s > zero).count();
    let raw = raw.singular_values();
    let smallest = raw.iter().copied().fold(f64::INFINITY, f64::min);
    let names: Vec<String> = problem.unknowns.list().iter().map(|u| u.name(problem.data)).collect();
    let units = |k: usize| if problem.unknowns.list()[k].is_length() { "mm" } else { "mrad" };
    let mut null = v_t.rows(rank, v_t.nrows() - rank).into_owned();
    // Tolerances that are not the usual ones are no mm and mrad.
    for (mut column, unknown) in null.column_iter_mut().zip(problem.unknowns.list()) {
        column *= scaled.unit(*unknown) / unknown.tolerance();
    }
    let weak = (0..rank).filter(|k| s[*k] < 1.0).map(|k| {
        let mut parts: Vec<usize> = (0..v_t.ncols()).collect();
        // To so many digits: two that trade off share alike, and rounding must not order them.
        let share = |j: &usize| (v_t[(k, *j)].abs() * 1e6).round() as i64;
        parts.sort_by_key(|j| std::cmp::Reverse(share(j)));
        let named = parts.into_iter().take(4).filter(|j| v_t[(k, *j)].abs() > 0.3);
        let named: Vec<&str> = named.map(|j| names[j].as_str()).collect();
        format!("{} (known to {:.1} tolerances only)", named.join(" with "), 1.0 / s[k])
    });
    Redundancy {
        rank,
        condition: s[0] / s[rank.max(1) - 1],
        condition_raw: if smallest > 0.0 { raw.max() / smallest } else { f64::INFINITY },
        redundant: sentences(null, problem.unknowns.list(), &names, &units),
        weak: weak.collect(),
    }
}

/// The link columns of the rows, m and rad, up to a rotation: those in tolerances
/// where all equations are of one unit.
fn raw(problem: &Problem, at: &State, rows: &[usize], scaled: &DMatrix<f64>) -> DMatrix<f64> {
    let free = problem.unknowns.free();
    let links = |all: &DMatrix<f64>| all.columns(free, all.ncols() - free).into_owned();
    let Some(unit) = Values::common(rows.iter().map(|row| problem.scale(*row))) else {
        let printed = Problem { scaling: Scaling::Printed, ..problem.clone() };
        return links(&printed.linearise(at).triangle(rows, None).matrix());
    };
    let mut links = links(scaled);
    for (mut column, unknown) in links.column_iter_mut().zip(&problem.unknowns.list()[free..]) {
        column *= unit / problem.unit(*unknown);
    }
    links
}

/// Pairs of this correlation are told together rather than each.
const CORRELATED: f64 = 0.95;
/// What the data leave wider than this share of a tolerance is told as redundant
/// or weak; its correlations are those of the tolerances.
const DETERMINED: f64 = 0.3;
/// Most pairs named.
const PAIRS: usize = 6;

/// Pairs of arm parameters that are each determined, but trade against one
/// another, the closest first; from the covariance of all unknowns, SI.
#[must_use]
pub fn correlated(problem: &Problem, covariance: &DMatrix<f64>) -> Vec<String> {
    let list = problem.unknowns.list();
    let sigma = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    let determined = |k: &usize| {
        !matches!(list[*k], Unknown::Station(..) | Unknown::Term(_) | Unknown::Instrument(..))
            && sigma(*k) > 0.0
            && sigma(*k) < DETERMINED * problem.tolerance(list[*k])
    };
    let known: Vec<usize> = (0..list.len()).filter(determined).collect();
    let mut pairs = Vec::new();
    for (i, a) in known.iter().enumerate() {
        for b in &known[i + 1..] {
            let correlation = covariance[(*a, *b)] / sigma(*a) / sigma(*b);
            if correlation.abs() > CORRELATED {
                pairs.push((correlation, *a, *b));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let with_bar = |k: usize| {
        let (factor, unit) = if list[k].is_length() { (1e3, "mm") } else { (1e3, "mrad") };
        let name = list[k].name(problem.data);
        format!("{name} (+-{:.3} {unit})", 1.96 * sigma(k) * factor)
    };
    let sentence = |(correlation, a, b): &(f64, usize, usize)| {
        let better = (1.0 - correlation * correlation).max(1e-12).sqrt().recip();
        format!(
            "{} and {} trade against each other: correlation {correlation:+.3}; if one were known \
             the other would be {better:.1} times better known",
            with_bar(*a),
            with_bar(*b)
        )
    };
    pairs.iter().take(PAIRS).map(sentence).collect()
}

/// A sparse basis of the null space, one sentence a direction.
///
/// Gauss-Jordan elimination: each direction gets a parameter that no other
/// direction contains, link parameters first, from the base outwards.
fn sentences(
    mut null: DMatrix<f64>,
    unknowns: &[Unknown],
    names: &[String],
    unit: &dyn Fn(usize) -> &'static str,
) -> Vec<String> {
    let count = null.nrows();
    let mut order: Vec<usize> = (0..unknowns.len()).collect();
    order.sort_by_key(|k| !matches!(unknowns[*k], Unknown::Link(..)));
    let mut pivots = Vec::new();
    for column in order {
        let done = pivots.len();
        if done == count {
            break;
        }
        let row = (done..count)
            .max_by(|a, b| null[(*a, column)].abs().total_cmp(&null[(*b, column)].abs()));
        let Some(row) = row.filter(|r| null[(*r, column)].abs() > 0.05) else { continue };
        null.swap_rows(done, row);
        let pivot = null[(done, column)];
        null.row_mut(done).unscale_mut(pivot);
        for other in (0..count).filter(|r| *r != done) {
            let factor = null[(other, column)];
            let step = null.row(done) * factor;
            let mut target = null.row_mut(other);
            target -= step;
        }
        pivots.push(column);
    }
    let sentence = |(row, pivot): (usize, &usize)| {
        let mut parts: Vec<usize> =
            (0..names.len()).filter(|k| k != pivot && null[(row, *k)].abs() > NAMED).collect();
        parts.sort_by(|a, b| null[(row, *b)].abs().total_cmp(&null[(row, *a)].abs()));
        let rest = parts.len().saturating_sub(6);
        let part = |k: &usize| format!("{} {:+.2} {}", names[*k], null[(row, *k)], unit(*k));
        let listed: Vec<String> = parts.iter().take(6).map(part).collect();
        let first = format!("{} +1.00 {}", names[*pivot], unit(*pivot));
        let more = if rest > 0 { format!(", {rest} more") } else { String::new() };
        if listed.is_empty() {
            format!("{} moves no measured point", names[*pivot])
        } else {
            format!("{first} with {}{more} moves no measured point", listed.join(", "))
        }
    };
    pivots.iter().enumerate().map(sentence).collect()
}
