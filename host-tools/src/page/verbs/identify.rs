use super::super::charts::Step;
use super::super::document::Page;
use super::super::numbers::mm;
use super::super::picture::{Measured, Seen, left};
use super::super::sections::{self, next};
use super::{file_name, noise_floor_mm, of_figures, rows_of};
use crate::error::Result;
use crate::report::IdentifyReport;
use crate::statistics::Stats;

/// Residuals so many times the stated noise say that something is missing.
const LACKING: f64 = 3.0;

/// The page of `identify`.
///
/// # Errors
/// Rows of stations or markers that the model does not have.
pub fn identified(report: &IdentifyReport, on: &Measured, next: &next::Next) -> Result<Page> {
    let f = &report.figures;
    let seen = Seen::new(*on)?;
    let steps = steps(report);
    let lacking = f.residual_over_sigma > LACKING;
    let (before, after) = (steps[0].fitted.unwrap_or(0.0), steps[1].held_out.or(steps[1].fitted));
    let after = after.unwrap_or(0.0);
    let rest = match lacking {
        true => format!(
            "; the residuals are {:.1} times the stated noise, so this model lacks something that \
             `truearm diagnose` looks for",
            f.residual_over_sigma
        ),
        false => format!("; the residuals are {:.1} times the stated noise", f.residual_over_sigma),
    };
    let floor = noise_floor_mm(on);
    let mut all = vec![sections::gap(&steps, Some(floor), &f.cross_validation)];
    let names = ["before, nominal", "after, identified"];
    all.extend(sections::workspace(&on.in_robot_frame(), names, "row"));
    all.extend(sections::left(&left(&seen), &[], "the geometry"));
    all.extend(of_figures(f, &[]));
    all.push(next::steps(&commands(lacking, next)));
    all.extend(sections::remarks(&f.warnings));
    Ok(Page {
        title: format!("{}: identified from {}", f.robot, file_name(&f.data)),
        verdict: format!(
            "The arm misses by {} as drawn and by {} with the identified geometry (RMS{}){rest}.",
            mm(before),
            mm(after),
            if steps[1].held_out.is_some() { ", poses held out" } else { "" }
        ),
        mood: if lacking { "doubt" } else { "good" },
        numbers: vec![
            ("error before, RMS".to_owned(), mm(before)),
            ("error after, held out, RMS".to_owned(), mm(after)),
            ("noise alone, RMS".to_owned(), mm(floor)),
            rows_of(f),
            ("rows left out".to_owned(), f.outliers.len().to_string()),
        ],
        sections: all,
    })
}

/// From the drawing to the identified arm.
fn steps(report: &IdentifyReport) -> [Step; 2] {
    let (f, v) = (&report.figures, report.validation.as_ref());
    let rms = |s: Option<Stats>| s.map(|s| s.rms_mm);
    [
        Step {
            name: "nominal".to_owned(),
            fitted: rms(f.nominal),
            held_out: None,
            other: v.map(|v| v.nominal_rms_mm),
        },
        Step {
            name: "geometry identified".to_owned(),
            fitted: rms(f.identified),
            held_out: rms(f.cross_validated),
            other: v.map(|v| v.stats.rms_mm),
        },
    ]
}

/// What comes next; where something lacks, `diagnose` first.
fn commands(lacking: bool, next: &next::Next) -> Vec<(String, String)> {
    let mut out = next::commands("identify", &[], next);
    if lacking {
        let nothing = next::Next { out: None, ..next.clone() };
        let (_, line) = next::commands("diagnose", &[], &nothing).remove(0);
        out.insert(0, ("what the geometry lacks".to_owned(), line));
    }
    out
}
