use super::super::charts::{Floor, Step};
use super::super::document::{Page, Section};
use super::super::numbers::{file_name, mm, period};
use super::super::picture::{Measured, Seen, parts, unexplained};
use super::super::sections::{self, folded, next};
use super::{of_figures, rows_of};
use crate::diagnose::{Effect, GapRow, GapUnit, Outcome, Verdict};
use crate::effects::OUTLIERS;
use crate::error::Result;
use crate::report::DiagnoseReport;

/// A model whose error of poses held out is above this share of the drawing's is none.
const BETTER: f64 = 0.8;
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
    let unit = r.gap_unit();
    let steps: Vec<Step> = r.gap.iter().map(|row| step(row, unit)).collect();
    let effects = [r.effects.clone(), r.suspected.clone()].concat();
    let clean = r.verdict == Verdict::Clean;
    let mut all = vec![
        sections::gap(&steps, floor(r), &f.cross_validation).say(sections::measured(on.model)),
        sections::effects(&r.effects, &r.suspected, &parts(&seen, &effects), clean),
    ];
    let curves = if r.verdict == Verdict::Unexplained { unexplained(&seen) } else { Vec::new() };
    all.extend(sections::unexplained(&curves, (&r.unnamed, &r.described), "the model"));
    let names = ["before, nominal", "after, final model"];
    all.extend(sections::workspace(&on.in_robot_frame(), names, "row"));
    all.extend(next::poses(r));
    all.extend(of_figures(f, &r.not_testable));
    all.extend(whereabouts(r));
    all.push(next::steps(Some(advice(r)), &next::commands("diagnose", &r.alternatives, next)));
    all.extend(sections::remarks(&f.warnings));
    let [before, after] = ends(r);
    let mut numbers = vec![
        ("error before, RMS".to_owned(), before),
        (format!("error after, {}, RMS", on_what(r)), after),
        ("noise over the stated".to_owned(), format!("{:.2}", r.noise_scale)),
        rows_of(f),
        ("rows left out".to_owned(), f.outliers.len().to_string()),
    ];
    if unit == GapUnit::Millimetres {
        numbers.insert(2, ("stated noise alone, RMS".to_owned(), mm(r.noise_floor_mm)));
        if let Some(nested) = r.nested_rms_mm {
            numbers.insert(2, ("held out, effects chosen anew, RMS".to_owned(), mm(nested)));
        }
    }
    Ok(Page {
        title: format!("{}: diagnosed from {}", f.robot, file_name(&f.data)),
        verdict: verdict(r),
        mood: if r.verdict == Verdict::Unexplained { "doubt" } else { "good" },
        numbers,
        sections: all,
    })
}

fn step(row: &GapRow, unit: GapUnit) -> Step {
    let [fitted, held_out, other] = unit.figures(row);
    Step { name: row.model.clone(), fitted, held_out, other }
}

fn floor(r: &Outcome) -> Floor {
    let axis = r.gap_unit().words();
    match r.gap_unit() {
        GapUnit::Millimetres => Floor { axis, unit: "mm", at: Some(r.noise_floor_mm) },
        GapUnit::Deviations => Floor { axis, unit: "sd", at: Some(1.0) },
    }
}

/// Error of the first and of the last model: of the hold-out file, or held out in folds, where
/// that is known.
fn ends(r: &Outcome) -> [String; 2] {
    let unit = r.gap_unit();
    [r.gap.first(), r.gap.last()].map(|row| {
        let [fitted, held_out, other] = row.map_or([None; 3], |row| unit.figures(row));
        let error = other.or(held_out).or(fitted).unwrap_or(0.0);
        match unit {
            GapUnit::Millimetres => mm(error),
            GapUnit::Deviations => format!("{error:.2} standard deviations of its noise"),
        }
    })
}

/// Which poses the last model's error is of.
fn on_what(r: &Outcome) -> &'static str {
    let [_, _, other] = r.gap.last().map_or([None; 3], |row| r.gap_unit().figures(row));
    if other.is_some() { "on the hold-out file" } else { "on poses held out" }
}

/// Whether the hold-out file is missed by more than chance and other noise make it.
fn worse_there(r: &Outcome) -> bool {
    let [_, held_out, other] = r.gap.last().map_or([None; 3], |row| r.gap_unit().figures(row));
    held_out.zip(other).is_some_and(|(held_out, other)| other > FARTHER * held_out)
}

/// Times the error of poses held out in folds: folds of a session differ by a tenth or two.
const FARTHER: f64 = 1.5;

/// What was found, in one sentence.
fn verdict(r: &Outcome) -> String {
    let [before, after] = ends(r);
    let what = match r.gap_unit() {
        GapUnit::Millimetres => "the arm misses",
        GapUnit::Deviations => "what was measured is missed",
    };
    let on = on_what(r);
    let fall = format!("{what} by {before} as drawn and by {after} with this model {on} (RMS)");
    let named = found(&r.effects).join("; ");
    let found = if named.is_empty() { String::new() } else { format!(" Found: {named}.") };
    let left = match r.leaves_noise() {
        true if worse_there(r) => "of poses as they were fitted what is left is noise".to_owned(),
        true => "what is left is noise".to_owned(),
        false => format!("what is left {}", r.what_is_left()),
    };
    match r.verdict {
        Verdict::Clean => format!("Clean: {fall}; with geometry alone {left}."),
        Verdict::Explained => format!("Explained: {fall}; {left}.{found}"),
        Verdict::Unexplained if named.is_empty() => format!(
            "Unexplained: {fall}, but structure is left that no effect of the repertoire explains."
        ),
        Verdict::Unexplained => {
            format!("Unexplained: {fall}, but structure is left beside what was found.{found}")
        }
    }
}

/// What to do with the model, in a sentence.
fn advice(r: &Outcome) -> &'static str {
    let figures = |row: Option<&GapRow>| {
        let [fitted, held_out, other] = row.map_or([None; 3], |row| r.gap_unit().figures(row));
        [other.or(held_out).or(fitted).unwrap_or(f64::INFINITY), fitted.unwrap_or(0.0)]
    };
    let [[held, _], [_, drawn]] = [figures(r.gap.last()), figures(r.gap.first())];
    let sound = r.verdict != Verdict::Unexplained;
    if held > BETTER * drawn {
        "Do not flash it: it predicts poses held out hardly better than the drawing does. Measure \
         more poses, or look for what is wrong with these."
    } else if sound && !r.leaves_noise() {
        "It may be flashed, and must be verified at poses that were not measured yet: what is left \
         is more than noise. Is the stated noise that of the instrument?"
    } else if sound && worse_there(r) {
        "It may be flashed, and must be verified where it is to work: the poses of the hold-out \
         file, which were not fitted, are missed by more than those held out. Measure some of \
         their kind and diagnose again."
    } else if sound && r.alternatives.is_empty() {
        "Flash it, and verify it at poses that were not measured yet."
    } else if sound {
        "Flash it, and verify it at poses that were not measured yet: where joints were measured, \
         the explanations predict alike. Before it is used elsewhere, measure the poses that tell \
         them apart and diagnose again."
    } else {
        "It may be flashed, as it predicts poses held out better than the drawing does, and must be \
         verified at poses that were not measured yet. Look for what is left first: it is the arm's \
         or the measurement's, and grows where nobody looked."
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
            .say("Before any effect was added; what of it is still there stands above.")
            .node(folded(&r.whereabouts, "observations"))
    })
}
