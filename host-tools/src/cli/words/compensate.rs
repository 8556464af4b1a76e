use truearm_host::error::count;
use truearm_host::model::Coordinates;
use truearm_host::report::{CompensateReport, RowLeft};

use super::Errors;

/// How many lines are named before the others are only counted.
const NAMED: usize = 8;

/// A report of `compensate`.
pub fn compensation(report: &CompensateReport, coordinates: Coordinates) -> String {
    let mut out = format!(
        "{}: {}, task {}, {}\n",
        report.path,
        count(report.rows, "row"),
        report.task,
        report.numbers
    );
    let mut table = Errors::new();
    table.row("as commanded, by the model", report.before.as_ref());
    table.row("corrected", report.left.as_ref());
    out += &table.text();
    // Of rows without joints nothing is known.
    if report.not_reached.len() < report.rows {
        out += &format!(
            "orientation: off by at most {:.4} degrees as commanded, {:.4} corrected\n",
            report.turns.before_max_deg, report.turns.left_max_deg
        );
    }
    out += &steps(report);
    if !report.clamped.is_empty() {
        out += &format!(
            "{} with a correction that was held back: {}\n",
            count(report.clamped.len(), "row"),
            lines(&report.clamped)
        );
    }
    out += &mostly_left(&report.mostly_left);
    out += &not_covered(report, coordinates);
    if report.not_reached.len() == report.rows {
        out += "no row is reached: are the poses those of [tool] in [base], in mm? --start gives \
                the configuration\n";
    }
    out + &not_reached(&report.not_reached)
}

/// How far joints move from a line to the next.
fn steps(report: &CompensateReport) -> String {
    let mut out = String::new();
    for step in &report.largest_steps {
        out += &format!(
            "largest step of a joint: {:.4} {unit} commanded, {:.4} {unit} corrected (joint {}, \
             to line {})\n",
            step.commanded,
            step.corrected,
            step.joint,
            step.line,
            unit = step.unit
        );
    }
    out
}

/// Rows that a correction helps little.
fn mostly_left(rows: &[RowLeft]) -> String {
    let worst = rows.iter().max_by(|a, b| a.left_mm.total_cmp(&b.left_mm));
    worst.map_or_else(String::new, |worst| {
        format!(
            "{} mostly as far off as commanded, by up to {:.3} mm (line {}): a joint would have to \
             move by more than 0.03 rad or m, beyond a limit, or the pose is near a singular one; move the \
             path or the part in the cell\n",
            count(rows.len(), "row"),
            worst.left_mm,
            worst.line
        )
    })
}

/// Rows outside what was measured, and what was done with them.
fn not_covered(report: &CompensateReport, coordinates: Coordinates) -> String {
    if report.not_covered.is_empty() {
        return String::new();
    }
    let done = match (report.extrapolated, coordinates) {
        (true, _) => "corrected by extrapolation, as asked",
        (false, Coordinates::Joints) => {
            "left as commanded (--extrapolate corrects them as a controller does)"
        }
        // Most poses have joints within the ranges and others outside.
        (false, _) => {
            "left as commanded (--start Q1,Q2,... chooses another configuration, and the whole \
             turns; --extrapolate corrects them as a controller does)"
        }
    };
    format!(
        "{} that the model does not cover (outside the joint ranges of the identification, or \
         where an error curve is not known), {done}: {}\n",
        count(report.not_covered.len(), "row"),
        lines(&report.not_covered)
    )
}

/// Rows that the arm does not reach.
pub fn not_reached(rows: &[RowLeft]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut out = format!("{} not reached, without joints:\n", count(rows.len(), "row"));
    for row in rows.iter().take(NAMED) {
        out += &format!(
            "  line {}: {:.3} mm and {:.4} degrees are left\n",
            row.line, row.left_mm, row.left_deg
        );
    }
    if rows.len() > NAMED {
        out += &format!("  and {} more\n", rows.len() - NAMED);
    }
    out
}

fn lines(lines: &[usize]) -> String {
    let named = super::list(&lines[..lines.len().min(NAMED)]);
    let what = if lines.len() == 1 { "line" } else { "lines" };
    if lines.len() > NAMED { format!("{what} {named} ...") } else { format!("{what} {named}") }
}
