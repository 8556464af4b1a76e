use super::super::charts::Step;
use super::super::document::{Page, Section};
use super::super::numbers::{mm, period};
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
    let names = ["before, nominal", "after, final model"];
    all.extend(sections::workspace(&on.in_robot_frame(), names, "row"));
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
    let names = found(&r.effects).join("; ");
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

/// The effects in a few words, waves of one name together: every joint with its
/// periods.
fn found(effects: &[Effect]) -> Vec<String> {
    let real = |e: &&Effect| e.name != OUTLIERS;
    let mut names: Vec<&str> = Vec::new();
    for e in effects.iter().filter(real) {
        if !names.contains(&e.name) {
            names.push(e.name);
        }
    }
    let mut out: Vec<String> = Vec::new();
    for name in names.iter().take(NAMED) {
        let own: Vec<&Effect> = effects.iter().filter(|e| e.name == *name).collect();
        match own.as_slice() {
            [alone] => out.push(sections::short(alone)),
            _ => out.push(waves(name, &own)),
        }
    }
    if names.len() > NAMED {
        out.push(format!("{} more", names.len() - NAMED));
    }
    out
}

/// Several effects of one name, joint by joint.
fn waves(name: &str, own: &[&Effect]) -> String {
    let mut joints: Vec<usize> = own.iter().flat_map(|e| e.joints.clone()).collect();
    joints.sort_unstable();
    joints.dedup();
    let place = |joint: &usize| {
        let of = own.iter().filter(|e| e.joints.contains(joint));
        let periods: Vec<String> = of.filter_map(|e| e.order).map(period).collect();
        match periods.is_empty() {
            true => format!("of joint {joint}"),
            false => format!("of joint {joint} every {}", periods.join(" and every ")),
        }
    };
    let places: Vec<String> = joints.iter().map(place).collect();
    format!("{} {}", name.replace('-', " "), places.join(", "))
}

/// Where geometry alone disagrees, in words.
fn whereabouts(r: &Outcome) -> Option<Section> {
    (!r.whereabouts.is_empty()).then(|| {
        Section::new("where", "Where geometry alone disagrees")
            .node(folded(&r.whereabouts, "observations"))
    })
}
