use super::super::charts::{method_errors, method_sizes};
use super::super::document::{Figure, Page, Section};
use super::super::numbers::{digits, mm};
use super::super::sections::{self, table};
use super::file_name;
use crate::methods::{Comparison, Outcome};
use crate::statistics::Stats;

fn judged(o: &Outcome) -> Option<Stats> {
    o.validation.or(o.fitted)
}

/// The page of `compare`.
#[must_use]
pub fn compared(found: &Comparison) -> Page {
    let solved = found.methods.iter().filter_map(|o| Some((o, judged(o)?)));
    let best = solved.clone().min_by(|a, b| a.1.mean_mm.total_cmp(&b.1.mean_mm));
    let first = solved.clone().next();
    let on = match &found.validation {
        Some(file) => format!("rows of {} that were not fitted", file_name(file)),
        None => {
            "the rows they were fitted to, which flatters methods that hold nothing back".to_owned()
        }
    };
    let verdict = match (first, best) {
        (Some((nominal, before)), Some((o, after))) => format!(
            "{} comes nearest: mean error {} where {} leaves {}, judged on {on}.",
            o.name,
            mm(after.mean_mm),
            nominal.name,
            mm(before.mean_mm)
        ),
        _ => "No method found an arm.".to_owned(),
    };
    let caption = "One shape and colour a method in all figures. Lines that lie on each other are of \
                   different widths.";
    let errors = Section::new("errors", "Errors of the methods")
        .figure(Figure::new("errors", caption, vec![method_errors(found)]))
        .figure(Figure::new(
            "methods",
            "Axes of decades: points, for there is no foot for a bar. Corrections far above the \
             tolerances say that a method bent the arm to the noise.",
            method_sizes(found).to_vec(),
        ))
        .node(numbers(found));
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

fn numbers(found: &Comparison) -> crate::markup::Element {
    let number = |x: Option<f64>| x.map_or("-".to_owned(), digits);
    let row = |o: &Outcome| {
        let s = judged(o);
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
