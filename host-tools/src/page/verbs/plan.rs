use std::path::Path;

use super::super::charts::covered;
use super::super::document::{Figure, Page, Section};
use super::super::numbers::{file_name, mm};
use super::super::picture::Arrow;
use super::super::sections::{self, table, typed};
use crate::model::Robot;
use crate::observations::KINDS;
use crate::plan::plural;
use crate::report::{PlanReport, SeparatedAlternative, SeparationReport};
use crate::units::{joint_column, joint_to_file};

/// Poses that were planned.
#[derive(Clone)]
pub struct Planned<'a> {
    /// The nominal arm.
    pub robot: &'a Robot,
    /// Where each joint may go, rad or m.
    pub limits: &'a [[f64; 2]],
    /// Joint values, rad or m.
    pub poses: &'a [Vec<f64>],
    /// The file they were written to.
    pub file: &'a Path,
    /// What to type when they were measured.
    pub then: String,
}

/// The page of `plan`.
#[must_use]
pub fn planned(report: &PlanReport, of: &Planned) -> Page {
    let um = |x: f64| format!("{x:.1} um");
    let target = match (report.target_um, report.target_reached) {
        (Some(target), Some(false)) => format!("; the target of {target} um is not reached"),
        (Some(target), _) => format!("; the target of {target} um is reached"),
        _ => String::new(),
    };
    let told = told(report);
    Page {
        title: format!("{}: {} {}", report.robot, report.poses, titled(report.kind)),
        verdict: format!(
            "Measured at these {} poses, the geometry of the arm will be known so well that {} is \
             predicted to {} anywhere in the region (3-D, 1 sigma), where as many random \
             poses give {}{target}; what geometry does not explain comes on top.",
            report.poses,
            report.what,
            um(report.worst_um),
            um(report.random_worst_um)
        ),
        mood: if report.target_reached == Some(false) { "doubt" } else { "good" },
        numbers: [
            Some(("poses".to_owned(), report.poses.to_string())),
            Some(("worst, 1 sigma".to_owned(), um(report.worst_um))),
            report.bound_um.map(|bound| ("no set is better than".to_owned(), um(bound))),
        ]
        .into_iter()
        .flatten()
        .collect(),
        sections: together(told, of, &report.warnings, &to_fill(report.kind)),
    }
}

/// How well the arm will be known.
fn told(report: &PlanReport) -> Section {
    let rows = [
        ("worst", Some(report.worst_um)),
        ("root mean square", Some(report.rms_um)),
        ("no set has a smaller worst than", report.bound_um),
        ("worst of as many random poses", Some(report.random_worst_um)),
        ("worst but for what stays open", report.determined.map(|d| d.worst_um)),
        ("the same of as many random poses", report.determined.map(|d| d.random_worst_um)),
    ];
    let rows =
        rows.into_iter().filter_map(|(name, x)| Some(vec![name.to_owned(), format!("{:.1}", x?)]));
    let head = format!("predicted 3-D standard deviation of {}, 1 sigma", report.what);
    let told = Section::new("told", "What they will tell")
        .node(table(&[&head, "um"], rows))
        .say(
            "Predicted from the geometry and the stated noise alone: it says how well links, base \
             and tool will be known. What bends, wears or turns with the angle is not in it; \
             truearm diagnose looks for that in what was measured.",
        )
        .say(format!(
            "{} parameters that {} can determine; poses chosen out of {} candidates. \
             Observability: O1 {:.4}, O2 {:.2e}, O3 {:.4}, O4 {:.2e}, O5 {:.4}.",
            report.parameters,
            plural(report.kind),
            report.candidates,
            report.observability.o1,
            report.observability.o2,
            report.observability.o3,
            report.observability.o4,
            report.observability.o5
        ));
    report.undetermined.iter().fold(told, |told, line| {
        told.say(format!("Left open, and held by the tolerances alone: {line}."))
    })
}

/// The page of `plan --discriminate`.
#[must_use]
pub fn separated(report: &SeparationReport, of: &Planned) -> Page {
    let row = |a: &SeparatedAlternative| {
        let worse = [a.worse_by_now, a.worse_by_planned].map(|x| format!("{x:.1}"));
        [vec![a.instead.clone()], worse.to_vec()].concat()
    };
    let head = ["alternative", "worse now, chi-square", "worse by these poses, expected"];
    let told = Section::new("told", "What they will tell")
        .node(table(&head, report.alternatives.iter().map(row)));
    let least =
        report.alternatives.iter().map(|a| a.worse_by_planned).fold(f64::INFINITY, f64::min);
    Page {
        title: format!("{}: {} poses to tell explanations apart", report.robot, report.poses),
        verdict: match report.alternatives.len() {
            0 => "There is nothing to tell apart.".to_owned(),
            n => format!(
                "Measured at these {} poses, {n} other explanation{} will be worse by {least:.0} in \
                 chi-square or more, if what was named is true.",
                report.poses,
                if n == 1 { "" } else { "s" }
            ),
        },
        mood: "plain",
        numbers: vec![("poses".to_owned(), report.poses.to_string())],
        sections: together(told, of, &report.warnings, &to_fill("point")),
    }
}

/// What the poses are for.
fn titled(kind: &str) -> String {
    match kind {
        "point" => "poses to measure".to_owned(),
        _ => format!("poses for measurements of kind {kind}"),
    }
}

/// What is to be done with a measurement of this kind.
fn to_fill(kind: &str) -> String {
    let columns = KINDS.iter().filter(|k| k.name() == kind).flat_map(|k| k.columns());
    let names: Vec<&str> = columns.map(|column| column.name).collect();
    match (kind, names.is_empty()) {
        ("point" | "pose", _) => format!("add {} to the rows", names.join(", ")),
        (_, true) => {
            "write the joint values that are read at contact into q1.. of the rows".to_owned()
        }
        _ => format!("fill in {} in the rows", names.join(", ")),
    }
}

/// What every plan shows: where the poses are and their joint values.
fn together(told: Section, of: &Planned, warnings: &[String], fill: &str) -> Vec<Section> {
    let kinds: Vec<_> = of.robot.joints.iter().map(|j| j.link.kind).collect();
    let target = of.robot.nominal_target();
    let arrow = |(k, q): (usize, &Vec<f64>)| {
        let point = target(q).translation;
        Arrow { row: k + 1, point, before: None, after: None }
    };
    let arrows: Vec<Arrow> = of.poses.iter().enumerate().map(arrow).collect();
    let caption = "Every planned pose as a dot, joint by joint, within the limits.";
    let joints = Section::new("joints", "What they cover").figure(Figure::new(
        "joints",
        caption,
        vec![covered(&kinds, of.limits, of.poses)],
    ));
    let names = kinds.iter().enumerate().map(|(j, kind)| joint_column("q", j, *kind));
    let names: Vec<String> = std::iter::once("pose".to_owned()).chain(names).collect();
    let head: Vec<&str> = names.iter().map(String::as_str).collect();
    let far = arrows.iter().map(|a| a.point.norm() * 1e3).fold(0.0, f64::max);
    let row = |(k, q): (usize, &Vec<f64>)| {
        let values =
            q.iter().zip(&kinds).map(|(v, kind)| format!("{:.3}", joint_to_file(*kind, *v)));
        std::iter::once((k + 1).to_string()).chain(values).collect()
    };
    let poses = Section::new("poses", "Poses to measure")
        .node(table(&head, of.poses.iter().enumerate().map(row)))
        .say(format!("The farthest target is {} from the base.", mm(far)));
    let next = Section::new("next", "What to do next")
        .say(format!(
            "Measure them and {fill} of {}; then:",
            file_name(&of.file.display().to_string())
        ))
        .node(typed(std::slice::from_ref(&of.then)));
    let mut out = vec![told];
    out.extend(sections::workspace(&arrows, ["", ""], "pose"));
    out.extend([joints, poses, next]);
    out.extend(sections::remarks(warnings));
    out
}
