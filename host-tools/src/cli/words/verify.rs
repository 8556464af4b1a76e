use truearm_host::report::{Judged, VerifyReport};
use truearm_host::table::Table;
use truearm_host::verify::{Conformity, KindVerified, OfPoints, Verification};

use super::{Errors, not_covered};

/// A report of `verify`.
pub fn verification(report: &VerifyReport) -> String {
    let after = &report.after;
    let mut out = format!("{}: {} rows of {} poses\n", after.file, after.rows, after.poses);
    if let Some(points) = &after.points {
        out += &of_points(report.before.as_ref(), points);
    }
    if after.has_others() {
        out += &of_kinds(report.before.as_ref(), &after.kinds);
    }
    if after.reregistered != "none" {
        out += &format!(
            "{} fitted on this file itself, as asked, for each pose on the others: what all poses \
             have in common of six directions of the error is not seen\n",
            after.reregistered
        );
    }
    if let Some(line) = not_covered(&after.joints_not_covered) {
        out += &format!("{line}\n");
    }
    out + &conformity(report)
}

fn of_points(before: Option<&Verification>, after: &OfPoints) -> String {
    let mut table = Errors::new();
    match before {
        Some(before) => {
            table.row("before, measured", before.points.as_ref().map(|p| &p.errors));
        }
        None => {
            let predicted = after.predicted_without_compensation.as_ref();
            table.row("before, as the model predicts", predicted);
        }
    }
    table.row("after", Some(&after.errors));
    let mut out = table.text();
    out += &format!(
        "positioning accuracy AP (ISO 9283): mean {:.4} mm, largest {:.4} mm of {} poses\n",
        after.accuracy.mean_mm, after.accuracy.max_mm, after.accuracy.poses
    );
    out += &match &after.repeatability {
        Some(rp) => format!(
            "positioning repeatability RP (ISO 9283): mean {:.4} mm, largest {:.4} mm of {} poses\n",
            rp.mean_mm, rp.max_mm, rp.poses
        ),
        None => "no pose was measured twice: no repeatability RP\n".to_owned(),
    };
    out + &format!(
        "expanded uncertainty of an error (k = 2): {:.4} mm\n",
        after.expanded_uncertainty_mm
    )
}

/// A line a kind, each in its own unit.
fn of_kinds(before: Option<&Verification>, after: &[KindVerified]) -> String {
    let head = ["error of a kind", "rows", "before, RMS", "after, RMS", "largest", "U (k = 2)"];
    let mut table = Table::new(head);
    for own in after {
        let same = |k: &&KindVerified| (k.kind, k.unit) == (own.kind, own.unit);
        let measured = before.map(|b| b.kinds.iter().find(same).map(|k| k.rms));
        let before = measured.unwrap_or(own.predicted_without_compensation_rms);
        let number = |x: f64| format!("{x:.4}");
        table.row([
            format!("{}, {}", own.kind, own.unit),
            own.rows.to_string(),
            before.map_or("-".to_owned(), number),
            number(own.rms),
            number(own.max),
            number(own.expanded_uncertainty),
        ]);
    }
    let whence = if before.is_some() { "measured" } else { "as the model predicts" };
    format!("{table}before: {whence}\n")
}

fn conformity(report: &VerifyReport) -> String {
    let alone = report.judged.len() == 1;
    let line = |j: &Judged| {
        let (tolerance, unit) = (j.tolerance, j.unit);
        let of = if alone { String::new() } else { format!(" of kind {}", j.kind) };
        match j.conformity {
            Conformity::Pass => format!("PASS: every error{of} is within {tolerance} {unit}\n"),
            Conformity::Fail => format!("FAIL: an error{of} is beyond {tolerance} {unit}\n"),
            Conformity::NotProven => format!(
                "NOT PROVEN: {tolerance} {unit} is within the uncertainty of the largest error{of}\n"
            ),
        }
    };
    let lines: String = report.judged.iter().map(line).collect();
    match report.judged.is_empty() {
        true => lines,
        false => format!("{lines}decision rule: {}\n", report.decision_rule),
    }
}
