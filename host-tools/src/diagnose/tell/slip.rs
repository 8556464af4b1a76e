//! Rows that look as if a joint had slipped on its encoder.

use nalgebra::DVector;

use crate::diagnose::chi_square::{chance, chi_square};
use crate::diagnose::policy::POLICY;
use crate::diagnose::search::node::Node;
use crate::diagnose::search::score::Scorer;
use crate::identify::Problem;
use crate::model::arm::Derivatives;
use crate::units::{joint_to_file, joint_unit};

/// Rows that pass together.
const GROUP: usize = 512;

/// The joint value's step, from some row to the last in the order of
/// measurement, that explains most of the residuals.
#[must_use]
pub fn step(problem: &Problem, root: &Node, lambda: f64) -> Vec<String> {
    let mut rows = root.fit.kept.clone();
    let row = |r: usize| &problem.data.rows[r];
    let when = |r: usize| row(r).time.or(row(r).order).unwrap_or(r as f64);
    rows.sort_by(|a, b| when(*a).total_cmp(&when(*b)));
    let Some(scorer) = Scorer::new(problem, &root.fit.fit, &rows, lambda) else {
        return Vec::new();
    };
    let joints = problem.nominal.len();
    let Step { explained, shift, joint, row: k } = largest(&scorer, joints);
    let all = root.reduced * root.freedom;
    let noise = ((all - explained) / root.freedom).max(1.0);
    let p = chi_square(explained / noise, 1) * (joints * rows.len()) as f64;
    if p > POLICY.significant || explained < POLICY.step * all {
        return Vec::new();
    }
    let kind = problem.nominal[joint].kind;
    let (shift, unit) = (joint_to_file(kind, shift), joint_unit(kind));
    vec![format!(
        "from row {} on joint {} is as if shifted by {shift:.4} {unit}, {:.0} % of the residual \
         variance ({}): has its encoder slipped?",
        rows[k] + 1,
        joint + 1,
        explained / all * 100.0,
        chance(p)
    )]
}

/// A joint value that is another from a row on.
#[derive(Clone, Copy, Default)]
struct Step {
    explained: f64,
    shift: f64,
    joint: usize,
    /// Place among the scorer's rows.
    row: usize,
}

/// The step that explains most: rows pass from the last to the first, each with
/// the sums of all that come after it.
fn largest(scorer: &Scorer, joints: usize) -> Step {
    let mut sums: Vec<(f64, f64, DVector<f64>)> = Vec::new();
    let mut best = Step::default();
    let groups = scorer.rows().len().div_ceil(GROUP);
    for group in (0..groups).rev() {
        let first = group * GROUP;
        let rows = &scorer.rows()[first..(first + GROUP).min(scorer.rows().len())];
        let of_joints = scorer.joint_rows(rows);
        if sums.is_empty() {
            let nothing = DVector::zeros(of_joints[0].products.nrows());
            sums = vec![(0.0, 0.0, nothing); joints];
        }
        for k in (0..rows.len()).rev().filter(|k| first + k > 0) {
            for (joint, (rows, (cc, cr, products))) in of_joints.iter().zip(&mut sums).enumerate() {
                *cc += rows.square[k];
                *cr += rows.right[k];
                *products += rows.products.column(k);
                let left = *cc - scorer.imitated(products);
                let explained = *cr * *cr / left;
                if left > 1e-4 * *cc && explained > best.explained {
                    best = Step { explained, shift: *cr / left, joint, row: first + k };
                }
            }
        }
    }
    best
}

/// Which rows contradict the others, and whether they do so as if a joint had
/// slipped.
#[must_use]
pub fn contradiction(problem: &Problem, root: &Node) -> Vec<String> {
    let (at, outliers) = (problem.linearise(&root.fit.fit.state), &root.fit.outliers);
    let rows: Vec<usize> = outliers.iter().map(|o| o.row + 1).collect();
    let of = problem.data.rows.len();
    let mut out =
        vec![format!("{} of {of} rows contradict the others: {}", rows.len(), ranges(&rows))];
    // Least squares of one shift of a joint in all of them.
    let fitted = |joint: usize| {
        let kind = problem.nominal[joint].kind;
        let moved = |_: usize, d: &Derivatives| vec![*d.links[joint].joint(kind)];
        let (mut cc, mut cr, mut rr) = (0.0, 0.0, 0.0);
        for outlier in outliers {
            let e = at.equations_beside(outlier.row, &moved);
            let column = e.block.column(e.block.ncols() - 1);
            let residual = e.scaled(&outlier.residual);
            cc += column.norm_squared();
            cr += column.dot(&residual.column());
            rr += residual.norm_squared();
        }
        (cr * cr / (cc * rr), joint, cr / cc)
    };
    let best = (0..problem.nominal.len()).map(fitted).max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((share, joint, shift)) = best.filter(|best| best.0 > POLICY.slipped) {
        let kind = problem.nominal[joint].kind;
        let (shift, unit) = (joint_to_file(kind, shift), joint_unit(kind));
        out.push(format!(
            "there joint {} is as if shifted by {shift:.4} {unit} ({:.0} % of their residuals): has \
             its encoder slipped?",
            joint + 1,
            share * 100.0
        ));
    }
    out
}

/// Rising numbers, runs of them as a range.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b).map(|run| match run {
        [one] => one.to_string(),
        [first, .., last] => format!("{first} to {last}"),
        [] => String::new(),
    });
    runs.collect::<Vec<_>>().join(", ")
}
