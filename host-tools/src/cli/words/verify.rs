use truearm_host::report::VerifyReport;
use truearm_host::verify::Conformity;

use super::{Errors, not_covered};

/// A report of `verify`.
pub fn verification(report: &VerifyReport) -> String {
    let after = &report.after;
    let mut out = format!("{}: {} rows of {} poses\n", after.file, after.rows, after.poses);
    let mut table = Errors::new();
    match &report.before {
        Some(before) => table.row("before, measured", Some(&before.errors)),
        None => {
            let predicted = after.predicted_without_compensation.as_ref();
            table.row("before, as the model predicts", predicted);
        }
    }
    table.row("after", Some(&after.errors));
    out += &table.text();
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
    out += &format!(
        "expanded uncertainty of an error (k = 2): {:.4} mm\n",
        after.expanded_uncertainty_mm
    );
    if after.reregistered != "none" {
        out += &format!("{} fitted on this file itself, as asked\n", after.reregistered);
    }
    if let Some(line) = not_covered(&after.joints_not_covered) {
        out += &format!("{line}\n");
    }
    out + &conformity(report)
}

fn conformity(report: &VerifyReport) -> String {
    let mut out = String::new();
    if let (Some(conformity), Some(mm)) = (report.conformity, report.tolerance_mm) {
        out += &match conformity {
            Conformity::Pass => format!("PASS: every error is within {mm} mm\n"),
            Conformity::Fail => format!("FAIL: an error is beyond {mm} mm\n"),
            Conformity::NotProven => {
                format!("NOT PROVEN: {mm} mm is within the uncertainty of the largest error\n")
            }
        };
        out += &format!("decision rule: {}\n", report.decision_rule);
    }
    out
}
