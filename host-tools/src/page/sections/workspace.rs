use super::super::charts::{magnified, projections};
use super::super::document::{Figure, Section};
use super::super::picture::Arrow;
use crate::markup::{Element, element};
use crate::units::point_to_mm;

/// Rows that the view draws, at most: evenly taken.
const MOST: usize = 4000;

/// Where the rows are, with their errors before and after; nothing where none
/// measured a point.
pub fn workspace(arrows: &[Arrow], names: [&str; 2], what: &str) -> Option<Section> {
    if arrows.is_empty() {
        return None;
    }
    let step = arrows.len().div_ceil(MOST).max(1);
    let drawn: Vec<Arrow> = arrows.iter().step_by(step).cloned().collect();
    let times = magnified(&drawn);
    let errors = drawn.iter().any(|a| a.before.is_some() || a.after.is_some());
    let scale = match errors {
        true => format!(
            " An error is a line from the measured point to where it would be if it were {times} \
             times as large; squares of the mesh are in mm."
        ),
        false => String::new(),
    };
    let of = match step {
        1 => format!("{} {what}s", drawn.len()),
        _ => format!("{} of {} {what}s", drawn.len(), arrows.len()),
    };
    let caption = format!("{of} in the robot's base frame, three views.{scale}");
    let section = Section::new("workspace", "Where in the workspace")
        .node(view(&drawn, names, what, times))
        .figure(Figure::new("workspace", caption, projections(&drawn, names, times)));
    Some(section)
}

/// The view that a script of the page turns; its data are numbers only.
fn view(arrows: &[Arrow], names: [&str; 2], what: &str, times: f64) -> Element {
    let button = |value: &'static str, text: &'static str| {
        element("button").with("type", "button").with("value", value).text(text)
    };
    let shown = |class: &'static str, name: &str| {
        let tick = element("input").with("type", "checkbox").with("class", class);
        element("label").child(tick.with("checked", "checked")).text(format!(" {name}"))
    };
    let mut bar = element("div").with("class", "bar");
    let both = [
        ("before", arrows.iter().any(|a| a.before.is_some())),
        ("after", arrows.iter().any(|a| a.after.is_some())),
    ];
    for ((class, there), name) in both.into_iter().zip(names) {
        if there {
            bar = bar.child(shown(class, name));
        }
    }
    let buttons = [
        ("above", "above"),
        ("front", "front"),
        ("side", "side"),
        ("back", "reset"),
        ("+", "+"),
        ("-", "\u{2212}"),
    ];
    bar = bar.children(buttons.map(|(value, text)| button(value, text)));
    if both[0].1 || both[1].1 {
        let longer = [("longer", "longer lines"), ("shorter", "shorter lines")];
        bar = bar.children(longer.map(|(value, text)| button(value, text)));
    }
    let drawing = element("svg")
        .with("class", "plot")
        .with("viewBox", "0 0 1000 700")
        .with("tabindex", "0")
        .with("role", "img")
        .with("aria-label", "The workspace; arrow keys turn it");
    let hint = "Drag or use the arrow keys to turn it; point at a dot for its numbers.";
    element("div")
        .with("class", "view")
        .with("data-rows", data(arrows, what, times))
        .child(bar)
        .child(drawing)
        .child(element("output").text(hint))
}

/// Numbers of the view as JSON: nothing in it that markup would change.
fn data(arrows: &[Arrow], what: &str, times: f64) -> String {
    let triple = |p: [f64; 3], places: usize| {
        format!("[{:.places$},{:.places$},{:.places$}]", p[0], p[1], p[2])
    };
    let points = arrows.iter().map(|a| triple(point_to_mm(&a.point), 1));
    let of = |error: fn(&Arrow) -> Option<nalgebra::Vector3<f64>>| {
        let all = arrows.iter().filter_map(error).map(|e| triple(point_to_mm(&e), 4));
        all.collect::<Vec<_>>().join(",")
    };
    format!(
        "{{\"what\":{what:?},\"times\":{times},\"rows\":{:?},\"points\":[{}],\"before\":[{}],\"after\":[{}]}}",
        arrows.iter().map(|a| a.row).collect::<Vec<_>>(),
        points.collect::<Vec<_>>().join(","),
        of(|a| a.before),
        of(|a| a.after)
    )
}
