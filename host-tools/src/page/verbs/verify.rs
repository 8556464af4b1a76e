use nalgebra::Vector3;

use super::super::charts::{before_and_after, shares};
use super::super::document::{Figure, Page, Section};
use super::super::numbers::{file_name, mm, runs};
use super::super::picture::Arrow;
use super::super::sections::{self, table};
use crate::model::{Commanded, Model};
use crate::plot::Ink;
use crate::report::{Judged, VerifyReport};
use crate::units::to_mm;
use crate::verify::{Conformity, KindVerified, OfPoints, Verification};

/// The page of `verify`.
#[must_use]
pub fn verified(report: &VerifyReport, model: &Model, commanded: &Commanded) -> Page {
    let after = &report.after;
    let mut all = Vec::new();
    if after.has_others() {
        all.push(kinds(report));
    }
    if let Some(points) = &after.points {
        all.push(errors(report, points));
        let arrows = arrows(report, model, commanded);
        all.extend(sections::workspace(&arrows, ["before", "after"], "row"));
        all.push(standard(report, points));
    }
    all.extend(sections::remarks(&report.warnings));
    let mut numbers =
        vec![("measured".to_owned(), format!("{} rows, {} poses", after.rows, after.poses))];
    if let Some(points) = &after.points {
        let of_points = [
            ("largest error".to_owned(), mm(points.errors.max_mm)),
            ("RMS error".to_owned(), mm(points.errors.rms_mm)),
            ("its uncertainty, k = 2".to_owned(), mm(points.expanded_uncertainty_mm)),
        ];
        numbers.splice(0..0, of_points);
    }
    numbers.extend(before_rms(report).map(|(b, how)| (format!("RMS error before, {how}"), mm(b))));
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

/// RMS error of points without compensation, mm, and whence it is known.
fn before_rms(report: &VerifyReport) -> Option<(f64, &'static str)> {
    let points = report.after.points.as_ref()?;
    let measured = report.before.as_ref().and_then(|b| b.points.as_ref()).map(|b| b.errors);
    let predicted = points.predicted_without_compensation;
    let measured = measured.map(|s| (s.rms_mm, "measured"));
    measured.or(predicted.map(|s| (s.rms_mm, "as the model predicts")))
}

/// The kind that decides: that of which the tolerances say the worst, else the first.
fn decisive(report: &VerifyReport) -> Option<(&KindVerified, Option<&Judged>)> {
    let judged = report.judged.iter().find(|j| Some(j.conformity) == report.conformity);
    let of = |j: &Judged| report.after.kinds.iter().find(|k| (k.kind, k.unit) == (j.kind, j.unit));
    Some((judged.and_then(of).or(report.after.kinds.first())?, judged))
}

fn verdict(report: &VerifyReport) -> String {
    let Some((own, judged)) = decisive(report) else { return String::new() };
    let (kind, unit) = (own.kind, own.unit);
    let size = |x: f64| if unit == "mm" { mm(x) } else { format!("{x:.4} {unit}") };
    let (largest, guard) = (size(own.max), size(own.expanded_uncertainty));
    let of = if report.after.has_others() { format!(" of kind {kind}") } else { String::new() };
    let tolerance = judged.map_or(0.0, |j| j.tolerance);
    let judged = match judged.map(|j| j.conformity) {
        Some(Conformity::Pass) => format!(
            "Pass: the largest error{of}, {largest} +- {guard}, is within the tolerance of \
             {tolerance} {unit}"
        ),
        Some(Conformity::Fail) => format!(
            "Fail: the largest error{of}, {largest} +- {guard}, is beyond the tolerance of \
             {tolerance} {unit}"
        ),
        Some(Conformity::NotProven) => format!(
            "Not proven: the tolerance of {tolerance} {unit} lies within the uncertainty of the \
             largest error{of}, {largest} +- {guard}"
        ),
        None => format!("The compensated arm misses{of} by {largest} +- {guard} at most"),
    };
    let fall = || {
        let ((before, how), after) =
            (before_rms(report)?, report.after.points.as_ref()?.errors.rms_mm);
        Some(match report.before.is_some() {
            true => format!("; RMS {} before, {} after", mm(before), mm(after)),
            false => {
                format!("; RMS {} measured, {} without compensation {how}", mm(after), mm(before))
            }
        })
    };
    format!("{judged}{}.", fall().unwrap_or_default())
}

/// A line a kind, each in its own unit.
fn kinds(report: &VerifyReport) -> Section {
    let number = |x: f64| format!("{x:.4}");
    let row = |own: &KindVerified| {
        let same = |k: &&KindVerified| (k.kind, k.unit) == (own.kind, own.unit);
        let measured = report.before.as_ref().map(|b| b.kinds.iter().find(same).map(|k| k.rms));
        let before = measured.unwrap_or(own.predicted_without_compensation_rms);
        let judged = report.judged.iter().find(|j| (j.kind, j.unit) == (own.kind, own.unit));
        let said = judged.map_or("-".to_owned(), |j| {
            let said = match j.conformity {
                Conformity::Pass => "pass",
                Conformity::Fail => "fail",
                Conformity::NotProven => "not proven",
            };
            format!("{said} ({} {})", j.tolerance, j.unit)
        });
        vec![
            format!("{}, {}", own.kind, own.unit),
            own.rows.to_string(),
            before.map_or("-".to_owned(), number),
            number(own.rms),
            number(own.max),
            number(own.expanded_uncertainty),
            said,
        ]
    };
    let head = ["kind", "rows", "before, RMS", "after, RMS", "largest", "U, k = 2", "tolerance"];
    let before = match report.before {
        Some(_) => "Before: measured with the compensation off.",
        None => "Before: as the model predicts it without compensation.",
    };
    Section::new("kinds", "Every kind in its own unit")
        .node(table(&head, report.after.kinds.iter().map(row)))
        .say(format!(
            "Errors are what was measured less what an arm that stands as commanded shows. {before} \
             U holds what is not known of the places that were found with the arm."
        ))
}

fn sizes(verification: &Verification) -> Vec<f64> {
    verification.row_errors.iter().flatten().map(|e| to_mm(e.norm())).collect()
}

fn errors(report: &VerifyReport, points: &OfPoints) -> Section {
    let after = sizes(&report.after);
    let before = report.before.as_ref().map(sizes).unwrap_or_default();
    let tolerance = report.tolerance_mm.map(|mm| (mm, points.expanded_uncertainty_mm));
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
    let of = |(i, after): (usize, &Option<Vector3<f64>>)| {
        let before = before.and_then(|b| b.row_errors[i]);
        Some(Arrow { row: i + 1, point: at(i), before, after: Some((*after)?) })
    };
    report.after.row_errors.iter().enumerate().filter_map(of).collect()
}

fn standard(report: &VerifyReport, after: &OfPoints) -> Section {
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
    let outside = &report.after.joints_not_covered;
    if !outside.is_empty() {
        section = section.say(format!(
            "Joints {} were commanded outside the range of the identification: there the model \
             extrapolates.",
            runs(outside)
        ));
    }
    section
}
