use super::super::picture::{Part, Unexplained};
use crate::diagnose::ErrorCourse;
use crate::plot::{Axis, Ink, Mark, Panel, Series};

/// Standard deviations on either side of 95 % of a normal distribution.
const WIDE: f64 = 1.96;

/// An effect against what it goes with: rows, fitted curve and its band.
#[must_use]
pub fn part(part: &Part) -> Panel {
    let x = match part.names.is_empty() {
        true => Axis::linear(part.x_label.clone()),
        false => Axis { label: part.x_label.clone(), ..Axis::names(part.names.clone()) },
    };
    // At a name rows stand side by side, in no order.
    let spread = |(k, p): (usize, &(f64, f64))| match part.names.is_empty() {
        true => *p,
        false => (p.0 + 0.5 * ((0.618_034 * k as f64).fract() - 0.5), p.1),
    };
    let points = part.points.iter().enumerate().map(spread).collect();
    let band = Series::new("its 95 % band", part.curve.clone(), Mark::Band);
    let fitted = match part.names.is_empty() {
        true => Mark::Line,
        false => Mark::Intervals,
    };
    let series = vec![
        Series::points("rows", points).ink(Ink::DATA),
        band.ends(part.band.clone()).ink(Ink::MODEL),
        Series::new("model", part.curve.clone(), fitted).ends(part.band.clone()).ink(Ink::MODEL),
    ];
    let means = Series::new("mean of a bin, 95 %", part.means.clone(), Mark::Intervals);
    let means = means.ends(part.intervals.clone()).ink(Ink(8));
    let kept = |s: &Series| part.names.is_empty() || s.mark != Mark::Band;
    let mut series: Vec<Series> = series.into_iter().filter(kept).collect();
    if !part.means.is_empty() {
        series.insert(1, means);
    }
    Panel::new(part.title.clone(), x, Axis::signed(part.y_label.clone()), series)
}

/// How a part of the cell errs with something recorded, with its band: one axis.
#[must_use]
pub fn described(course: &ErrorCourse, (part, with): (&str, &str)) -> Panel {
    let of = |y: &dyn Fn(&[f64; 3]) -> f64| course.points.iter().map(|p| (p[0], y(p))).collect();
    let line: Vec<(f64, f64)> = of(&|p| p[1]);
    let ends = course.points.iter().map(|[_, y, sd]| (y - WIDE * sd, y + WIDE * sd));
    let ends: Vec<(f64, f64)> = ends.collect();
    let series = vec![
        Series::new("its 95 % band", line.clone(), Mark::Band).ends(ends).ink(Ink::MODEL),
        Series::new("what it is off by", line, Mark::Line).ink(Ink::MODEL),
    ];
    let along = if course.axis.is_empty() { "" } else { " along " };
    let y = format!("error of {part}{along}{}, {}", course.axis, course.unit);
    let x = Axis::linear(format!("{with}, {}", course.at_unit));
    let title = format!("{part}{along}{} against {with}", course.axis);
    Panel::new(title, x, Axis::signed(y), series)
}

/// What is left against something recorded: means of bins with their intervals.
#[must_use]
pub fn free_curve(left: &Unexplained) -> Panel {
    let means = Series::new("mean of a bin, 95 %", left.means.clone(), Mark::Intervals);
    let series = vec![means.ends(left.intervals.clone()).ink(Ink::MODEL)];
    let (x, y) = (Axis::linear(left.x_label.clone()), Axis::signed(left.y_label.clone()));
    Panel::new(left.title.clone(), x, y, series)
}
