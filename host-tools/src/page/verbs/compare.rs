use super::super::charts::{method_errors, method_sizes};
use super::super::document::{Figure, Page, Section};
use super::super::numbers::{digits, file_name, mm};
use super::super::sections::{self, table};
use crate::methods::{Comparison, Outcome};

/// The page of `compare`.
#[must_use]
pub fn compared(found: &Comparison) -> Page {
    let first = found.methods.iter().find_map(|o| Some((o, o.judged()?)));
    let on = match &found.validation {
        Some(file) => format!("rows of {} that were not fitted", file_name(file)),
        None => {
            "the rows they were fitted to, which flatters methods that hold nothing back".to_owned()
        }
    };
    let verdict = match (first, found.best()) {
        (Some((nominal, before)), Some((best, error))) => format!(
            "{}: mean error {} where {} leaves {}, judged on {on}.",
            nearest(&best, error),
            mm(best[0].judged().map_or(0.0, |s| s.mean_mm)),
            nominal.name,
            mm(before.mean_mm)
        ),
        _ => "No method found an arm.".to_owned(),
    };
    let caption = "One shape and colour a method in all figures. A line that lies on that of another \
                   method, its errors within 3 % in nineteen rows of twenty, says so in its name.";
    let errors = Section::new("errors", "Errors of the methods")
        .figure(Figure::new("errors", caption, vec![method_errors(found)]))
        .figure(Figure::new(
            "methods",
            "Axes of decades: points, for there is no foot for a bar. Corrections far above the \
             tolerances say that a method bent the arm to the noise.",
            method_sizes(found).to_vec(),
        ))
        .node(numbers(found));
    let errors = match restless(found) {
        Some(names) => errors.say(format!("Did not come to rest: {names}.")),
        None => errors,
    };
    let about = found.methods.iter().map(|o| {
        let failure = o.failure.as_ref().map_or(String::new(), |why| format!(" It failed: {why}."));
        format!("{}: {}.{failure}", o.name, o.about)
    });
    let about = Section::new("about", "What they are").node(sections::list(about));
    let left_out = match found.outlier_rows.len() {
        0 => "none".to_owned(),
        n => n.to_string(),
    };
    let mut all = vec![errors, about];
    all.extend(sections::remarks(&found.warnings));
    Page {
        title: format!("{}: methods compared on {}", found.robot, file_name(&found.data)),
        verdict,
        mood: "plain",
        numbers: vec![
            ("rows fitted".to_owned(), found.rows.to_string()),
            ("rows left out for all".to_owned(), left_out),
            ("parameters, rank".to_owned(), format!("{}, {}", found.parameters, found.rank)),
            ("base and tool".to_owned(), found.frames.to_owned()),
        ],
        sections: all,
    }
}

/// Which came nearest, or which did alike.
fn nearest(best: &[&Outcome], error: f64) -> String {
    let names: Vec<&str> = best.iter().map(|o| o.name).collect();
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!(
            "{} and {last} come nearest and cannot be told apart, their means within the standard \
             error of one, {}",
            others.join(", "),
            mm(error)
        ),
        _ => format!("{} comes nearest", names.join("")),
    }
}

/// Methods that gave a result without having come to rest.
fn restless(found: &Comparison) -> Option<String> {
    let names = found.methods.iter().filter(|o| o.judged().is_some() && !o.settled);
    let names: Vec<&str> = names.map(|o| o.name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

fn numbers(found: &Comparison) -> crate::markup::Element {
    let number = |x: Option<f64>| x.map_or("-".to_owned(), digits);
    let row = |o: &Outcome| {
        let s = o.judged();
        let stats = [s.map(|s| s.max_mm), s.map(|s| s.mean_mm), s.map(|s| s.sd_mm)];
        let mut cells = vec![o.name.to_owned()];
        cells.extend(stats.map(number));
        cells.extend([o.mae_reduction_percent, o.correction_norm, o.lambda].map(number));
        cells.extend([o.iterations.to_string(), format!("{:.2}", o.seconds * 1e3)]);
        cells
    };
    let head = [
        "method",
        "largest, mm",
        "mean, mm",
        "SD, mm",
        "mean falls by, %",
        "corrections, tolerances",
        "lambda",
        "iterations",
        "time, ms",
    ];
    table(&head, found.methods.iter().map(row))
}
