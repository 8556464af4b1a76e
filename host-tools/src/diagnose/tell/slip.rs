//! Rows that look as if a joint had slipped on its encoder.

use crate::diagnose::chi_square::{chance, chi_square};
use crate::diagnose::crowd::slipped;
use crate::diagnose::node::Node;
use crate::diagnose::policy::POLICY;
use crate::diagnose::weigh::slips::{self, Step};
use crate::diagnose::weigh::{Weights, scan};
use crate::identify::Problem;
use crate::units::{joint_to_file, joint_unit};

/// The joint value's step, from some row to the last in the order of
/// measurement, that explains most of the residuals of one kind, with its p value.
#[must_use]
pub fn step(problem: &Problem, root: &Node, lambda: f64) -> Option<(f64, String)> {
    let rows = &root.fit.kept;
    let kind_of = |row: &usize| problem.data.rows[*row].kind;
    // Files put behind each other: from kind to kind steps what geometry lacks. Of pairs
    // a scan knows either end alone.
    let joined = |row: &usize| problem.data.rows[*row].partner.is_some();
    if rows.iter().any(|row| kind_of(row) != kind_of(&rows[0]) || joined(row)) {
        return None;
    }
    let weights = Weights::alike(problem.data.rows.len());
    let columns = scan::columns(problem, &root.fit.fit.state, rows, &weights, (lambda, 1.0), &[]);
    let order = slips::in_order(problem, rows);
    let strongest =
        slips::of_joints(&columns, &order).max_by(|a, b| a.1.explained.total_cmp(&b.1.explained));
    let (joint, Step { explained, shift, at }) = strongest?;
    let all = root.reduced * root.freedom;
    let noise = ((all - explained) / root.freedom).max(1.0);
    let p = chi_square(explained / noise, 1) * (columns.joints().len() * rows.len()) as f64;
    if p > POLICY.significant || explained < POLICY.step * all {
        return None;
    }
    let kind = problem.nominal[joint].kind;
    let (shift, unit) = (joint_to_file(kind, shift), joint_unit(kind));
    let words = format!(
        "from row {} on joint {} is as if shifted by {shift:.4} {unit}, {:.0} % of the residual \
         variance ({}): has its encoder slipped?",
        rows[at] + 1,
        joint + 1,
        explained / all * 100.0,
        chance(p)
    );
    Some((p, words))
}

/// Which rows contradict the others, and whether they do so as if a joint had
/// slipped.
#[must_use]
pub fn contradiction(problem: &Problem, root: &Node) -> Vec<String> {
    let rows: Vec<usize> = root.fit.outliers.iter().map(|o| o.row + 1).collect();
    let of = problem.data.rows.len();
    let mut out =
        vec![format!("{} of {of} rows contradict the others: {}", rows.len(), ranges(&rows))];
    if let Some((share, joint, shift)) = slipped(problem, root) {
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
