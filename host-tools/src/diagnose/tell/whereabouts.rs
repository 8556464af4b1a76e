//! Where the residuals of a geometric fit are: against every joint angle,
//! approach side, torque, temperature, time, series, payload and region.

use nalgebra::{DMatrix, DVector};

use super::slip::{contradiction, step};
use crate::diagnose::chi_square::{chance, chi_square};
use crate::diagnose::crowd::crowded;
use crate::diagnose::node::Node;
use crate::diagnose::policy::POLICY;
use crate::diagnose::weigh::Covariate;
use crate::identify::{Linearised, Problem};
use crate::model::{KindId, Row, Values};
use crate::observations::{by_pose, kind};

/// Sentences for what is significant, a joint that slipped first, then strongest
/// first, and the one that is least a chance, with its p value. `lambda` is that of the fit. No
/// joint is said to have slipped that has not beside what was found, if anything was: the best
/// model and a problem without what has no name.
#[must_use]
pub fn sentences(
    problem: &Problem,
    root: &Node,
    found: Option<(&Problem, &Node)>,
    lambda: f64,
) -> (Vec<String>, Option<(f64, String)>) {
    // Where many rows are flagged, the flags are what is to be placed.
    let all: Vec<usize> = (0..problem.data.rows.len()).collect();
    let crowded = crowded(problem, root);
    let rows = if crowded { &all } else { &root.fit.kept };
    let significant = significant(tests(problem, root, rows));
    let slips =
        !crowded && found.is_none_or(|(problem, best)| step(problem, best, lambda).is_some());
    let slip = if slips { step(problem, root, lambda) } else { None };
    let least = significant.iter().chain(&slip).min_by(|a, b| a.0.total_cmp(&b.0)).cloned();
    let contradiction = if crowded { contradiction(problem, root) } else { Vec::new() };
    let told = slip.into_iter().chain(significant).map(|(_, sentence)| sentence);
    (contradiction.into_iter().chain(told).collect(), least)
}

/// Residuals of poses: readings of one are one, as what moves one of them moves all.
struct Poses {
    readings: Vec<Vec<usize>>,
    residuals: Vec<(KindId, Values)>,
}

impl Poses {
    /// Of some rows.
    fn of(at: &Linearised, data: &[Row], rows: &[usize]) -> Self {
        let readings = by_pose(data, rows);
        let mean = |readings: &Vec<usize>| {
            let all: Vec<Values> = readings.iter().map(|k| at.scaled_residual(rows[*k])).collect();
            let of = |c: usize| all.iter().map(|r| r[c]).sum::<f64>() / all.len() as f64;
            (data[rows[readings[0]]].kind, Values::from_fn(all[0].len(), of))
        };
        let residuals = readings.iter().map(mean).collect();
        Self { readings, residuals }
    }

    /// [`dependence`] on functions of each row.
    fn dependence(&self, each: &[Vec<f64>]) -> Option<(f64, f64)> {
        let mean = |readings: &Vec<usize>| {
            let sum = |j: usize| readings.iter().map(|k| each[*k][j]).sum::<f64>();
            (0..each[readings[0]].len()).map(|j| sum(j) / readings.len() as f64).collect()
        };
        let functions: Vec<Vec<f64>> = self.readings.iter().map(mean).collect();
        dependence(&self.residuals, &functions)
    }
}

/// Of every name the share that functions of the rows explain which stand for it, and its p
/// value.
fn tests(problem: &Problem, root: &Node, rows: &[usize]) -> Vec<(String, Option<(f64, f64)>)> {
    let at = problem.linearise(&root.fit.fit.state);
    let poses = Poses::of(&at, &problem.data.rows, rows);
    let row = |i: usize| &problem.data.rows[rows[i]];
    let inputs = |i: usize| &problem.conditions.rows[rows[i]];
    let mut tests: Vec<(String, Option<(f64, f64)>)> = Vec::new();
    // Of many rows the functions of one at a time are enough.
    let mut test = |name: String, functions: &dyn Fn(usize) -> Option<Vec<f64>>| {
        let each = (0..rows.len()).map(functions).collect::<Option<Vec<_>>>();
        tests.extend(each.map(|each| (name, poses.dependence(&each))));
    };
    for j in 0..problem.nominal.len() {
        let wave = |q: f64| vec![q, q.cos(), q.sin(), (2.0 * q).cos(), (2.0 * q).sin()];
        test(Covariate::Joint(j).words(problem), &|i| Some(wave(row(i).q[j])));
        test(format!("the approach side of joint {}", j + 1), &|i| {
            row(i).directions.get(j).map(|d| vec![f64::from(*d)])
        });
        test(format!("the gravity torque of joint {}", j + 1), &|i| {
            inputs(i).torque.get(j).map(|t| vec![*t])
        });
    }
    test("the overturning moment".to_owned(), &|i| Some(inputs(i).moment.to_vec()));
    test("temperature".to_owned(), &|i| row(i).temperature.map(|t| vec![t]));
    let timed = (0..rows.len()).all(|i| row(i).clock().is_some());
    test(if timed { "time" } else { "the order of the rows" }.to_owned(), &|i| {
        Some(vec![row(i).clock().filter(|_| timed).unwrap_or(rows[i] as f64)])
    });
    test("payload".to_owned(), &|i| row(i).payload.map(|m| vec![m]));
    let series = &problem.conditions.series;
    test("the series".to_owned(), &|i| {
        let of = |label: &String| f64::from(u8::from(row(i).series.as_ref() == Some(label)));
        Some(series.iter().skip(1).map(of).collect())
    });
    test("the region of the workspace".to_owned(), &|i| {
        let target = at.target(rows[i]).0;
        // A closure's target is where its point is, less the residual: of what is no point
        // itself only the place is taken, or the residual would explain itself.
        let own = kind(row(i)).point(row(i)).is_some();
        let place = if own { target } else { target.map(|x| (x / PLACE).round() * PLACE) };
        Some(place.iter().copied().collect())
    });
    tests
}

/// What residuals go with beyond chance, the most first, and the chance.
fn significant(tests: Vec<(String, Option<(f64, f64)>)>) -> Vec<(f64, String)> {
    let count = tests.len() as f64;
    let mut found: Vec<(f64, f64, String)> = Vec::new();
    for (name, dependence) in tests {
        let Some((share, p)) = dependence else { continue };
        if p * count < POLICY.significant {
            let (percent, chance) = (share * 100.0, chance(p * count));
            let sentence =
                format!("{percent:.0} % of the residual variance goes with {name} ({chance})");
            found.push((share, p * count, sentence));
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, p, sentence)| (p, sentence)).collect()
}

/// Places nearer to each other than this are one, m: more than residuals are, and less
/// than a workspace.
const PLACE: f64 = 0.02;

/// Share of the residuals' variance that linear functions explain, in all
/// components, and its p value (likelihood ratio). Residuals are in sigmas; rows
/// of one kind are explained together.
fn dependence(residuals: &[(KindId, Values)], functions: &[Vec<f64>]) -> Option<(f64, f64)> {
    let (mut before, mut after, mut equations, mut freedom) = (0.0, 0.0, 0, 0);
    let mut kinds: Vec<KindId> = residuals.iter().map(|r| r.0).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        let rows: Vec<usize> = (0..residuals.len()).filter(|i| residuals[*i].0 == kind).collect();
        let Some(basis) = basis(&rows, functions) else { continue };
        let components = residuals[rows[0]].1.len();
        for c in 0..components {
            let r = DVector::from_fn(rows.len(), |i, _| residuals[rows[i]].1[c]);
            before += (&r - DVector::from_element(rows.len(), r.mean())).norm_squared();
            after += r.norm_squared() - basis.tr_mul(&r).norm_squared();
        }
        equations += components * rows.len();
        freedom += components * (basis.ncols() - 1);
    }
    let share = 1.0 - after / before;
    let statistic = -(equations as f64) * (1.0 - share).ln();
    (equations > 0).then(|| (share, chi_square(statistic, freedom)))
}

/// Orthonormal columns that span a constant and the functions at some rows;
/// `None` of too few rows or of functions that stand still.
fn basis(rows: &[usize], functions: &[Vec<f64>]) -> Option<DMatrix<f64>> {
    let (n, k) = (rows.len(), functions.first()?.len());
    if k == 0 || n < 4 * (k + 1) {
        return None;
    }
    let at = |i: usize, j: usize| if j == 0 { 1.0 } else { functions[rows[i]][j - 1] };
    let mut a = DMatrix::from_fn(n, k + 1, at);
    for j in 1..=k {
        let scale = a.column(j).amax();
        if scale == 0.0 {
            return None;
        }
        a.column_mut(j).unscale_mut(scale);
    }
    let svd = a.svd(true, false);
    let rank = svd.singular_values.iter().filter(|s| **s > 1e-9 * svd.singular_values[0]).count();
    (rank >= 2).then(|| svd.u.map(|u| u.columns(0, rank).into_owned()))?
}
