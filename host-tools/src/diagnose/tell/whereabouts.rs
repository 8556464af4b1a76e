//! Where the residuals of a geometric fit are: against every joint angle,
//! approach side, torque, temperature, time, series, payload and region.

use nalgebra::{DMatrix, DVector, Vector3};

use super::slip::{contradiction, step};
use crate::diagnose::chi_square::{chance, chi_square};
use crate::diagnose::policy::POLICY;
use crate::diagnose::search::node::{Node, crowded};
use crate::identify::Problem;

/// Sentences for what is significant, a joint that slipped first, then strongest
/// first. `lambda` is that of the fit.
#[must_use]
pub fn sentences(problem: &Problem, root: &Node, lambda: f64) -> Vec<String> {
    let at = problem.linearise(&root.fit.fit.state);
    // Where many rows are flagged, the flags are what is to be placed.
    let all: Vec<usize> = (0..problem.data.rows.len()).collect();
    let rows = if crowded(root) { &all } else { &root.fit.kept };
    let residuals: Vec<Vector3<f64>> = rows.iter().map(|r| at.residual(*r)).collect();
    let row = |i: usize| &problem.data.rows[rows[i]];
    let inputs = |i: usize| &problem.conditions.rows[rows[i]];
    let joints = problem.nominal.len();
    // A name and the functions of each row that stand for it.
    let mut tests: Vec<(String, Vec<Vec<f64>>)> = Vec::new();
    let mut test = |name: String, functions: &dyn Fn(usize) -> Option<Vec<f64>>| {
        if let Some(rows) = (0..rows.len()).map(functions).collect::<Option<Vec<_>>>() {
            tests.push((name, rows));
        }
    };
    for j in 0..joints {
        let wave = |q: f64| vec![q, q.cos(), q.sin(), (2.0 * q).cos(), (2.0 * q).sin()];
        test(format!("the angle of joint {}", j + 1), &|i| Some(wave(row(i).q[j])));
        test(format!("the approach side of joint {}", j + 1), &|i| {
            row(i).directions.get(j).map(|d| vec![f64::from(*d)])
        });
        test(format!("the gravity torque of joint {}", j + 1), &|i| {
            inputs(i).torque.get(j).map(|t| vec![*t])
        });
    }
    test("the overturning moment".to_owned(), &|i| Some(inputs(i).moment.to_vec()));
    test("temperature".to_owned(), &|i| row(i).temperature.map(|t| vec![t]));
    let timed = (0..rows.len()).all(|i| row(i).time.or(row(i).order).is_some());
    test(if timed { "time" } else { "the order of the rows" }.to_owned(), &|i| {
        Some(vec![row(i).time.or(row(i).order).filter(|_| timed).unwrap_or(rows[i] as f64)])
    });
    test("payload".to_owned(), &|i| row(i).payload.map(|m| vec![m]));
    let series = &problem.conditions.series;
    test("the series".to_owned(), &|i| {
        let of = |label: &String| f64::from(u8::from(row(i).series.as_ref() == Some(label)));
        Some(series.iter().skip(1).map(of).collect())
    });
    test("the region of the workspace".to_owned(), &|i| {
        Some(row(i).point.iter().copied().collect())
    });
    let count = tests.len() as f64;
    let mut found: Vec<(f64, String)> = Vec::new();
    for (name, functions) in tests {
        let Some((share, p)) = dependence(&residuals, &functions) else { continue };
        if p * count < POLICY.significant {
            let (percent, chance) = (share * 100.0, chance(p * count));
            let sentence =
                format!("{percent:.0} % of the residual variance goes with {name} ({chance})");
            found.push((share, sentence));
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let slips =
        if crowded(root) { contradiction(problem, root) } else { step(problem, root, lambda) };
    slips.into_iter().chain(found.into_iter().map(|(_, sentence)| sentence)).collect()
}

/// Share of the residuals' variance that linear functions explain, in all three
/// coordinates, and its p value (likelihood ratio).
fn dependence(residuals: &[Vector3<f64>], functions: &[Vec<f64>]) -> Option<(f64, f64)> {
    let (n, k) = (residuals.len(), functions.first()?.len());
    if k == 0 || n < 4 * (k + 1) {
        return None;
    }
    let mut a = DMatrix::from_element(n, k + 1, 1.0);
    for (i, f) in functions.iter().enumerate() {
        for (j, v) in f.iter().enumerate() {
            a[(i, j + 1)] = *v;
        }
    }
    for j in 1..=k {
        let scale = a.column(j).amax();
        if scale == 0.0 {
            return None;
        }
        a.column_mut(j).unscale_mut(scale);
    }
    let svd = a.svd(true, false);
    let rank = svd.singular_values.iter().filter(|s| **s > 1e-9 * svd.singular_values[0]).count();
    if rank < 2 {
        return None;
    }
    let u = svd.u?;
    let (mut before, mut after) = (0.0, 0.0);
    for c in 0..3 {
        let r = DVector::from_fn(n, |i, _| residuals[i][c]);
        before += (&r - DVector::from_element(n, r.mean())).norm_squared();
        after += r.norm_squared() - u.columns(0, rank).tr_mul(&r).norm_squared();
    }
    let share = 1.0 - after / before;
    let statistic = -3.0 * n as f64 * (1.0 - share).ln();
    Some((share, chi_square(statistic, 3 * (rank - 1))))
}
