use truearm_host::check::{Verdict, together};
use truearm_host::report::CheckReport;

/// What is wrong between a robot file and its measurements.
pub fn checked(report: &CheckReport) -> String {
    let before = report.rms_before_mm;
    let mut out = match report.verdict {
        Verdict::Sound => {
            let agree = report.stray.as_ref().map_or(before, |stray| stray.others_mm);
            let but = if report.stray.is_some() { " but for single rows" } else { "" };
            format!("no gross mistake{but}: robot and measurements agree to {agree:.2} mm RMS\n")
        }
        Verdict::Mendable => String::from("found wrong:\n"),
        Verdict::NotUnderstood => match &report.too_few {
            Some(why) => format!("cannot be decided: {why}\n"),
            None if report.stray.as_ref().is_some_and(|stray| stray.many) => {
                String::from("not understood:\n")
            }
            None => format!(
                "not understood: robot and measurements disagree by {before:.0} mm RMS, and no one \
                 or two mistakes explain it; are they of the same arm?\n"
            ),
        },
    };
    for change in &report.changes {
        out += &format!("  {change}\n");
    }
    // Of a mistake in some rows it is said which these are.
    let in_part = report.changes.iter().any(|change| change.rows.is_some());
    if let Some(stray) = report.stray.as_ref().filter(|_| !in_part) {
        out += &format!("{}{stray}\n", if stray.many { "  " } else { "" });
    }
    if report.verdict == Verdict::Mendable {
        out += &misfits(report);
        if !report.equivalent.is_empty() {
            out += "the data cannot tell it from:\n";
        }
        for other in &report.equivalent {
            out += &format!("  {}\n", together(other));
        }
    }
    if !report.absorbed.is_empty() {
        let list = report.absorbed.join(", ");
        out += &format!("not testable here, as base or tool would absorb it: {list}\n");
    }
    out
}

/// What mending leaves, and what the next explanation does.
fn misfits(report: &CheckReport) -> String {
    let (before, after) = (report.rms_before_mm, report.rms_after_mm);
    let mut out = match before < ALIKE * after {
        // What is off by less than the links can be bent by.
        true => format!(
            "misfit {after:.2} mm RMS with that mended, and as the files are only with a link \
             that is {:.0} tolerances off",
            report.largest_correction_tolerances
        ),
        false => {
            format!("misfit {before:.2} mm RMS as the files are, {after:.2} mm with that mended")
        }
    };
    if let Some(margin) = report.margin {
        let farther = if margin < 1.0 { ", with an arm farther from its drawing" } else { "" };
        let times = match margin {
            m if m < 0.1 => "less than a tenth as much".to_owned(),
            m => format!("{m:.1} times as much"),
        };
        out += &format!("; the next explanation leaves {times}{farther}");
    }
    out + "\n"
}

/// Misfits whose ratio is below this are alike.
const ALIKE: f64 = 1.5;
