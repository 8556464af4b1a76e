use super::super::charts::{Floor, Step};
use super::super::document::Page;
use super::super::numbers::{file_name, mm};
use super::super::picture::{Measured, Seen, unexplained};
use super::super::sections::{self, next};
use super::{noise_floor_mm, of_figures, rows_of};
use crate::diagnose::GapUnit;
use crate::error::{Result, count};
use crate::identify::KindFigures;
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
    // One after the other: of many rows each takes megabytes.
    let names = ["before, nominal", "after, identified"];
    let workspace = sections::workspace(&on.in_robot_frame(), names, "row");
    let left = unexplained(&Seen::new(*on)?);
    let steps = steps(report);
    let lacking = f.residual_over_sigma > LACKING;
    let after = steps[1].held_out.or(steps[1].fitted).unwrap_or(0.0);
    let rest = match lacking {
        true => format!(
            "; the residuals are {:.1} times the stated noise, so this model lacks something that \
             truearm diagnose looks for",
            f.residual_over_sigma
        ),
        false => format!("; the residuals are {:.1} times the stated noise", f.residual_over_sigma),
    };
    let noise = noise_floor_mm(on);
    let floor = Floor { axis: GapUnit::Millimetres.words(), unit: "mm", at: Some(noise) };
    let lengths = steps[0].fitted.is_some();
    let mut all = Vec::new();
    if lengths {
        all.push(sections::gap(&steps, floor, &f.cross_validation));
    }
    all.extend(workspace);
    all.extend(sections::unexplained(&left, (&[], &[]), "the geometry"));
    all.extend(of_figures(f, &[]));
    all.push(next::steps(None, &commands(lacking, next)));
    all.extend(sections::remarks(&f.warnings));
    let left_out = f.drawn.as_ref().map_or(f.outliers.len(), |drawn| drawn.flagged);
    let mut numbers = vec![rows_of(f), ("rows left out".to_owned(), left_out.to_string())];
    if let Some(drawn) = &f.drawn {
        let what = "drawn by chance; distances, single rows and pictures are of these";
        numbers.push((what.to_owned(), count(drawn.rows, "row")));
    }
    if let Some(before) = steps[0].fitted {
        let lengths = [
            ("error before, RMS".to_owned(), mm(before)),
            ("error after, held out, RMS".to_owned(), mm(after)),
            ("noise alone, RMS".to_owned(), mm(noise)),
        ];
        numbers.splice(0..0, lengths);
    }
    Ok(Page {
        title: format!("{}: identified from {}", f.robot, file_name(&f.data)),
        verdict: match steps[0].fitted {
            Some(before) => format!(
                "The arm misses by {} as drawn and by {} with the identified geometry (RMS{}){rest}.",
                mm(before),
                mm(after),
                if steps[1].held_out.is_some() { ", poses held out" } else { "" }
            ),
            None => format!("{}{rest}.", in_own_units(&f.kinds)),
        },
        mood: if lacking { "doubt" } else { "good" },
        numbers,
        sections: all,
    })
}

/// What is off where no row says how far, each kind in its own unit.
fn in_own_units(kinds: &[KindFigures]) -> String {
    let own = |k: &KindFigures| {
        let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.3} {}", k.unit));
        let after = k.cross_validated_rms.or(k.identified_rms);
        format!("{} {} as drawn, {} identified", k.kind, number(k.nominal_rms), number(after))
    };
    let all: Vec<String> = kinds.iter().map(own).collect();
    format!("RMS of what was measured: {}", all.join("; "))
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
            other: v.and_then(|v| v.nominal_rms_mm),
        },
        Step {
            name: "geometry identified".to_owned(),
            fitted: rms(f.identified),
            held_out: rms(f.cross_validated),
            other: rms(v.and_then(|v| v.stats)),
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
