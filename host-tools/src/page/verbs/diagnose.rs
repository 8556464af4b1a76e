use super::super::charts::Step;
use super::super::document::{Page, Section};
use super::super::numbers::mm;
use super::super::picture::{Measured, Seen, left, parts};
use super::super::sections::{self, folded, next};
use super::{file_name, of_figures, rows_of};
use crate::diagnose::{Effect, GapRow, Outcome, Verdict};
use crate::effects::OUTLIERS;
use crate::error::Result;
use crate::report::DiagnoseReport;

/// Effects that the verdict names.
const NAMED: usize = 4;

/// The page of `diagnose`.
///
/// # Errors
/// Rows of stations or markers that the model does not have.
pub fn diagnosed(report: &DiagnoseReport, on: &Measured, next: &next::Next) -> Result<Page> {
    let r = &report.outcome;
    let f = &r.figures;
    let seen = Seen::new(*on)?;
    let steps: Vec<Step> = r.gap.iter().map(step).collect();
    let effects = [r.effects.clone(), r.suspected.clone()].concat();
    let clean = r.verdict == Verdict::Clean;
    let mut all = vec![
        sections::gap(&steps, Some(r.noise_floor_mm), &f.cross_validation),
        sections::effects(&r.effects, &r.suspected, &parts(&seen, &effects), clean),
    ];
    let curves = if r.verdict == Verdict::Unexplained { left(&seen) } else { Vec::new() };
    all.extend(sections::left(&curves, &r.unnamed, "the model"));
    all.push(sections::workspace(
        &on.in_robot_frame(),
        ["before, nominal", "after, final model"],
        "row",
    ));
    all.extend(next::poses(r));
    all.extend(of_figures(f, &r.not_testable));
    all.extend(whereabouts(r));
    all.push(next::steps(&next::commands("diagnose", &r.alternatives, next)));
    all.extend(sections::remarks(&f.warnings));
    let (before, after) = ends(&r.gap);
    let mut numbers = vec![
        ("error before, RMS".to_owned(), mm(before)),
        ("error after, held out, RMS".to_owned(), mm(after)),
        ("stated noise alone, RMS".to_owned(), mm(r.noise_floor_mm)),
        ("noise over the stated".to_owned(), format!("{:.2}", r.noise_scale)),
        rows_of(f),
        ("rows left out".to_owned(), f.outliers.len().to_string()),
    ];
    if let Some(nested) = r.nested_rms_mm {
        numbers.insert(2, ("held out, effects chosen anew, RMS".to_owned(), mm(nested)));
    }
    Ok(Page {
        title: format!("{}: diagnosed from {}", f.robot, file_name(&f.data)),
        verdict: verdict(r),
        mood: if r.verdict == Verdict::Unexplained { "doubt" } else { "good" },
        numbers,
        sections: all,
    })
}

fn step(row: &GapRow) -> Step {
    Step {
        name: row.model.clone(),
        fitted: Some(row.train_rms_mm),
        held_out: row.cross_validated_rms_mm,
        other: row.holdout_rms_mm,
    }
}

/// Error of the first and of the last model, mm: held out where that is known.
fn ends(gap: &[GapRow]) -> (f64, f64) {
    let of = |row: &GapRow| row.cross_validated_rms_mm.unwrap_or(row.train_rms_mm);
    (gap.first().map_or(0.0, of), gap.last().map_or(0.0, of))
}

/// What was found, in one sentence.
fn verdict(r: &Outcome) -> String {
    let (before, after) = ends(&r.gap);
    let fall = format!(
        "the arm misses by {} as drawn and by {} with this model on poses held out (RMS)",
        mm(before),
        mm(after)
    );
    let found: Vec<&Effect> = r.effects.iter().filter(|e| e.name != OUTLIERS).collect();
    let mut names: Vec<String> = found.iter().take(NAMED).map(|e| sections::short(e)).collect();
    if found.len() > NAMED {
        names.push(format!("{} more", found.len() - NAMED));
    }
    let names = names.join("; ");
    match (r.verdict, names.is_empty()) {
        (Verdict::Clean, _) => {
            format!("Clean: {fall}, and geometry alone leaves nothing but noise.")
        }
        (Verdict::Explained, true) => format!("Explained: {fall}, and what is left is noise."),
        (Verdict::Explained, false) => {
            format!("Explained: {fall}, and what is left is noise; found: {names}.")
        }
        (Verdict::Unexplained, true) => format!(
            "Unexplained: {fall}, but structure is left that no effect of the repertoire explains."
        ),
        (Verdict::Unexplained, false) => {
            format!("Unexplained: {fall}, but structure is left beside what was found: {names}.")
        }
    }
}

/// Where geometry alone disagrees, in words.
fn whereabouts(r: &Outcome) -> Option<Section> {
    (!r.whereabouts.is_empty()).then(|| {
        Section::new("where", "Where geometry alone disagrees")
            .node(folded(&r.whereabouts, "observations"))
    })
}
