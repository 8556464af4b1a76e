//! Rows that look as if a joint had slipped on its encoder.

use truearm::JointKind;

use crate::diagnose::chi_square::{chance, chi_square};
use crate::diagnose::policy::POLICY;
use crate::diagnose::search::node::Node;
use crate::diagnose::search::score::Scorer;
use crate::identify::Problem;
use crate::units::{joint_to_file, joint_unit};

/// The joint value's step, from some row to the last in the order of
/// measurement, that explains most of the residuals.
#[must_use]
pub fn step(problem: &Problem, root: &Node, lambda: f64) -> Vec<String> {
    let mut rows = root.fit.kept.clone();
    let row = |r: usize| &problem.data.rows[r];
    let when = |r: usize| row(r).time.or(row(r).order).unwrap_or(r as f64);
    rows.sort_by(|a, b| when(*a).total_cmp(&when(*b)));
    let state = &root.fit.fit.state;
    let Some(scorer) = Scorer::new(problem, state, &rows, lambda) else { return Vec::new() };
    let joints = problem.nominal.len();
    // What is explained, the shift, the joint, the first row.
    let mut best = (0.0, 0.0, 0, 0);
    for joint in 0..joints {
        let columns = scorer.joint(joint);
        let (mut cc, mut cr) = (0.0, 0.0);
        let mut imitated = columns.projected.column(0) * 0.0;
        for k in (1..rows.len()).rev() {
            cc += columns.square[k];
            cr += columns.right[k];
            imitated += columns.projected.column(k);
            let left = cc - imitated.norm_squared();
            if left > 1e-4 * cc && cr * cr / left > best.0 {
                best = (cr * cr / left, cr / left, joint, k);
            }
        }
    }
    let (explained, shift, joint, k) = best;
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
        let revolute = problem.nominal[joint].kind == JointKind::Revolute;
        let (mut cc, mut cr, mut rr) = (0.0, 0.0, 0.0);
        for outlier in outliers {
            let link = at.equations(outlier.row).derivatives.links[joint];
            let column = link[if revolute { 2 } else { 3 }];
            cc += column.norm_squared();
            cr += column.dot(&outlier.residual);
            rr += outlier.residual.norm_squared();
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
