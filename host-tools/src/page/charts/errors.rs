//! Errors of rows: how many are better than what, and methods beside each other.

use crate::methods::{self, Comparison, Outcome};
use crate::observations::Residual;
use crate::plot::{Axis, Ink, Mark, Panel, Rule, Series};
use crate::statistics::Stats;
use crate::units::to_mm;

/// Points of a curve of shares, at most.
const MOST: usize = 400;

/// Share of rows below an error, of several lists of errors in mm.
#[must_use]
pub fn shares(title: &str, lists: Vec<(String, Vec<f64>, Ink)>) -> Panel {
    let line = |(name, mut errors, ink): (String, Vec<f64>, Ink)| {
        errors.sort_by(f64::total_cmp);
        let count = errors.len();
        let share = |i: usize| 100.0 * (i as f64 + 1.0) / count as f64;
        // As many places as can be told apart.
        let step = count.div_ceil(MOST).max(1);
        let places = (0..count).filter(|i| i % step == 0 || i + 1 == count);
        Series::line(name, places.map(|i| (errors[i], share(i))).collect()).ink(ink)
    };
    let series = lists.into_iter().filter(|l| !l.1.is_empty()).map(line).collect();
    let (x, y) = (Axis::log("position error, mm"), Axis::linear("rows below, %"));
    Panel::new(title, x, y, series)
}

fn solved(found: &Comparison) -> Vec<&Outcome> {
    found.methods.iter().filter(|o| o.state.is_some()).collect()
}

/// Errors that differ by less than this share are drawn at about one place.
const SAME: f64 = 0.03;
/// Share of the rows of which they do; the smallest errors are far apart on an axis of decades.
const MOST_OF_THEM: f64 = 0.95;

/// The first method of which the curve of errors lies where this one's does.
#[must_use]
pub fn coincides(found: &Comparison, of: &Outcome) -> Option<&'static str> {
    let sorted = |o: &Outcome| {
        let mut errors: Vec<f64> = o.judged_residuals().iter().map(Residual::norm).collect();
        errors.sort_by(f64::total_cmp);
        errors
    };
    let own = sorted(of);
    let same = |o: &&&Outcome| {
        let other = sorted(o);
        let near = own.iter().zip(&other).filter(|(a, b)| (*a - *b).abs() <= SAME * a.max(**b));
        near.count() as f64 >= MOST_OF_THEM * own.len() as f64
    };
    let solved = solved(found);
    let before = solved.iter().take_while(|o| o.name != of.name);
    before.clone().find(same).map(|o| o.name)
}

/// How many rows are better than an error, a line a method.
#[must_use]
pub fn method_errors(found: &Comparison) -> Panel {
    let list = |o: &&Outcome| {
        let errors = o.judged_residuals().iter().map(|r| to_mm(r.norm())).collect();
        let name = match coincides(found, o) {
            Some(first) => format!("{} (on {first})", o.name),
            None => o.name.to_owned(),
        };
        (name, errors, methods::ink(o.name))
    };
    let on = if found.validation.is_some() { "validation" } else { "fitted" };
    let title = format!("How many {on} rows are better than an error");
    shares(&title, solved(found).iter().map(list).collect())
}

/// Errors of the methods, and the size of their corrections: points on axes of
/// decades, where no bar has a foot.
#[must_use]
pub fn method_sizes(found: &Comparison) -> [Panel; 2] {
    let solved = solved(found);
    let names: Vec<String> = solved.iter().map(|o| o.name.to_owned()).collect();
    let of = |value: &dyn Fn(&Outcome) -> Option<f64>| {
        solved.iter().map(|o| value(o).unwrap_or(f64::NAN)).collect::<Vec<f64>>()
    };
    let stats = |f: fn(&Stats) -> f64| of(&|o| o.judged().as_ref().map(f));
    let on = if found.validation.is_some() { "validation" } else { "fitted" };
    let errors = Panel::new(
        format!("Position error, {on} rows"),
        Axis::names(names.clone()),
        Axis::log("position error, mm"),
        vec![
            Series::bars("largest", &stats(|s| s.max_mm)).ink(Ink::BEFORE),
            Series::bars("mean", &stats(|s| s.mean_mm)).ink(Ink::AFTER),
            Series::bars("standard deviation", &stats(|s| s.sd_mm)).ink(Ink::FITTED),
        ],
    );
    let sizes = Panel::new(
        "Norm of the corrections",
        Axis::names(names),
        Axis::log("manufacturing tolerances (1 mm, 1 mrad)"),
        vec![Series::bars("", &of(&|o| o.correction_norm)).ink(Ink::MODEL)],
    );
    [errors, sizes]
}

/// Error of every row before and after, mm, with the tolerance.
#[must_use]
pub fn before_and_after(before: &[f64], after: &[f64], tolerance: Option<(f64, f64)>) -> Panel {
    let series = |name: &str, errors: &[f64], ink: Ink| {
        let points = crate::plot::numbered(errors);
        let note = |(i, e): (usize, &f64)| format!("row {}: {e:.4} mm", i + 1);
        let notes = errors.iter().enumerate().map(note).collect();
        Series::new(name, points, Mark::Points).notes(notes).ink(ink)
    };
    let all = [series("before", before, Ink::BEFORE), series("after", after, Ink::AFTER)];
    let drawn = all.into_iter().filter(|s| !s.points.is_empty()).collect();
    let (x, y) = (Axis::linear("row"), Axis::linear("position error, mm"));
    let mut panel = Panel::new("Position error of every row", x, y, drawn);
    if let Some((mm, guard)) = tolerance {
        panel
            .rules
            .push(Rule { at: mm, name: format!("tolerance {mm} mm; below, less its uncertainty") });
        if mm > guard {
            panel.rules.push(Rule { at: mm - guard, name: String::new() });
        }
    }
    panel
}
