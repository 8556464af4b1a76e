use super::super::charts::{Floor, Step, staircase};
use super::super::document::{Figure, Section};
use super::table;

/// The gap from the drawing to the final model.
pub fn gap(steps: &[Step], floor: Floor, held_out: &str) -> Section {
    let cell = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.4}"));
    let row = |s: &Step| vec![s.name.clone(), cell(s.fitted), cell(s.held_out), cell(s.other)];
    let other = steps.iter().any(|s| s.other.is_some());
    let head = [floor.axis, "fitted rows", "held out in folds", "hold-out file"];
    let columns = if other { 4 } else { 3 };
    let rows = steps.iter().map(|s| row(s).into_iter().take(columns).collect());
    let caption = "Each step adds one thing to the model. Believe the figures of poses that were \
                   not fitted: what falls there is not only fitted better, it predicts better. The \
                   dashed line is what noise alone leaves; of poses that were not fitted no model \
                   comes far below it.";
    Section::new("gap", "How the error falls")
        .figure(Figure::new("staircase", caption, vec![staircase(steps, floor)]))
        .node(table(&head[..columns], rows))
        .say(format!("Held out in folds: {held_out}."))
}
