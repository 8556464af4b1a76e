use nalgebra::Vector3;

use super::super::charts::{before_and_after, shares};
use super::super::document::{Figure, Page, Section};
use super::super::numbers::{mm, runs};
use super::super::picture::Arrow;
use super::super::sections::{self, table};
use super::file_name;
use crate::model::{Commanded, Model};
use crate::plot::Ink;
use crate::report::VerifyReport;
use crate::units::to_mm;
use crate::verify::{Conformity, Verification};

/// The page of `verify`.
#[must_use]
pub fn verified(report: &VerifyReport, model: &Model, commanded: &Commanded) -> Page {
    let after = &report.after;
    let mut all = vec![errors(report)];
    let arrows = arrows(report, model, commanded);
    all.extend(sections::workspace(&arrows, ["before", "after"], "row"));
    all.push(standard(report));
    all.extend(sections::remarks(&report.warnings));
    let before = before_rms(report);
    let mut numbers = vec![
        ("largest error".to_owned(), mm(after.errors.max_mm)),
        ("RMS error".to_owned(), mm(after.errors.rms_mm)),
        ("its uncertainty, k = 2".to_owned(), mm(after.expanded_uncertainty_mm)),
        ("measured".to_owned(), format!("{} rows, {} poses", after.rows, after.poses)),
    ];
    numbers.extend(before.map(|b| ("RMS error before".to_owned(), mm(b))));
    Page {
        title: format!("{}: verified on {}", model.robot.name, file_name(&after.file)),
        verdict: verdict(report),
        mood: match report.conformity {
            Some(Conformity::Pass) => "good",
            Some(Conformity::Fail) => "bad",
            Some(Conformity::NotProven) => "doubt",
            None => "plain",
        },
        numbers,
        sections: all,
    }
}

/// RMS error without compensation, mm: measured, or as the model predicts.
fn before_rms(report: &VerifyReport) -> Option<f64> {
    let predicted = report.after.predicted_without_compensation;
    report.before.as_ref().map(|b| b.errors).or(predicted).map(|s| s.rms_mm)
}

fn verdict(report: &VerifyReport) -> String {
    let after = &report.after;
    let (largest, guard) = (mm(after.errors.max_mm), mm(after.expanded_uncertainty_mm));
    let tolerance = report.tolerance_mm.unwrap_or(0.0);
    let judged = match report.conformity {
        Some(Conformity::Pass) => format!(
            "Pass: the largest error, {largest} +- {guard}, is within the tolerance of {tolerance} mm"
        ),
        Some(Conformity::Fail) => format!(
            "Fail: the largest error, {largest} +- {guard}, is beyond the tolerance of {tolerance} mm"
        ),
        Some(Conformity::NotProven) => format!(
            "Not proven: the tolerance of {tolerance} mm lies within the uncertainty of the largest \
             error, {largest} +- {guard}"
        ),
        None => format!("The compensated arm misses by {largest} +- {guard} at most"),
    };
    let fall = before_rms(report).map_or(String::new(), |before| {
        format!("; RMS {} before, {} after", mm(before), mm(after.errors.rms_mm))
    });
    format!("{judged}{fall}.")
}

fn sizes(verification: &Verification) -> Vec<f64> {
    verification.row_errors.iter().map(|e| to_mm(e.norm())).collect()
}

fn errors(report: &VerifyReport) -> Section {
    let after = sizes(&report.after);
    let before = report.before.as_ref().map(sizes).unwrap_or_default();
    let tolerance = report.tolerance_mm.map(|mm| (mm, report.after.expanded_uncertainty_mm));
    let rows = before_and_after(&before, &after, tolerance);
    let lists =
        vec![("before".to_owned(), before, Ink::BEFORE), ("after".to_owned(), after, Ink::AFTER)];
    let share = shares("How many rows are better than an error", lists);
    let caption =
        "Distance from the commanded to the measured point of every row. No row is left out.";
    Section::new("errors", "Errors of the rows").figure(Figure::new(
        "errors",
        caption,
        vec![rows, share],
    ))
}

/// Measured points with their errors, in the coordinates of the files.
fn arrows(report: &VerifyReport, model: &Model, commanded: &Commanded) -> Vec<Arrow> {
    let target = model.robot.nominal_target();
    let file = model.robot.base.pose();
    let rows = &commanded.data.rows;
    let at = |i: usize| match commanded.points.get(i) {
        Some(point) => file.transform_point(point),
        None => target(&rows[i].q).translation,
    };
    // Before and after of one row only where the same was commanded.
    let same =
        |b: &&Verification| b.row_errors.len() == rows.len() && b.poses == report.after.poses;
    let before = report.before.as_ref().filter(same);
    let of = |(i, after): (usize, &Vector3<f64>)| Arrow {
        row: i + 1,
        point: at(i),
        before: before.map(|b| b.row_errors[i]),
        after: Some(*after),
    };
    report.after.row_errors.iter().enumerate().map(of).collect()
}

fn standard(report: &VerifyReport) -> Section {
    let after = &report.after;
    let rp = after.repeatability.as_ref();
    let none = || "no pose was measured twice".to_owned();
    let rows = [
        ["mean error".to_owned(), mm(after.errors.mean_mm)],
        ["largest error".to_owned(), mm(after.errors.max_mm)],
        ["positioning accuracy AP, mean".to_owned(), mm(after.accuracy.mean_mm)],
        ["positioning accuracy AP, largest".to_owned(), mm(after.accuracy.max_mm)],
        ["positioning repeatability RP, mean".to_owned(), rp.map_or_else(none, |r| mm(r.mean_mm))],
        [
            "positioning repeatability RP, largest".to_owned(),
            rp.map_or_else(none, |r| mm(r.max_mm)),
        ],
        ["expanded uncertainty of an error, k = 2".to_owned(), mm(after.expanded_uncertainty_mm)],
    ];
    let mut section = Section::new("iso", "By ISO 9283")
        .node(table(&["compensated arm", "value"], rows.map(Vec::from)))
        .say(format!("Decision rule: {}.", report.decision_rule));
    if !after.joints_not_covered.is_empty() {
        section = section.say(format!(
            "Joints {} were commanded outside the range of the identification: there the model \
             extrapolates.",
            runs(&after.joints_not_covered)
        ));
    }
    section
}
