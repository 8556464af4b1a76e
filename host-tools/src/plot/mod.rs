//! Figures as SVG: one or more panels of lines, points, bars, bands and arrows.
//!
//! A panel is an element for a page ([`Panel::drawn`]) or a file that stands by
//! itself ([`Panel::svg`], [`grid`]); both look alike, in light and in dark. Every
//! series is a group whose attribute `data-marks` says how many marks it has.

mod axis;
mod frame;
mod marks;
#[cfg(feature = "png")]
pub mod png;
mod series;
mod strokes;
mod style;

pub use axis::Axis;
pub use series::{Ink, Mark, Series, numbered};
pub use style::STYLE;

use std::ops::Range;

use crate::markup::{Element, Node, element};
use frame::Layout;

/// A line of reference across a panel.
#[derive(Debug, Clone)]
pub struct Rule {
    /// Its y.
    pub at: f64,
    /// What it is.
    pub name: String,
}

/// A panel.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Above the panel.
    pub title: String,
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// What is drawn, the later over the earlier.
    pub series: Vec<Series>,
    /// Lines of reference.
    pub rules: Vec<Rule>,
    /// A unit is as long across as up.
    pub equal: bool,
    /// Width and height.
    pub size: (f64, f64),
}

/// Width and height of a panel.
const SIZE: (f64, f64) = (560.0, 360.0);

impl Default for Panel {
    fn default() -> Self {
        Self {
            title: String::new(),
            x: Axis::default(),
            y: Axis::default(),
            series: Vec::new(),
            rules: Vec::new(),
            equal: false,
            size: SIZE,
        }
    }
}

impl Panel {
    /// Of these axes and series.
    #[must_use]
    pub fn new(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self { title: title.into(), x, y, series, ..Self::default() }
    }

    /// The panel alone, as a file.
    #[must_use]
    pub fn svg(&self) -> String {
        grid(std::slice::from_ref(self), 1)
    }

    /// The panel without its title, for a page that has the style.
    #[must_use]
    pub fn drawn(&self) -> Element {
        let untitled = Self { title: String::new(), ..self.clone() };
        let (width, height) = self.size;
        let root = element("svg")
            .with("class", "plot")
            .with("viewBox", format!("0 0 {width} {height}"))
            .with("role", "img")
            .child(element("title").text(&self.title));
        root.children(untitled.parts())
    }

    /// What stands in a panel.
    fn parts(&self) -> Vec<Node> {
        let layout = Layout::of(self);
        let mut out = layout.frame(self);
        let inks = self.inks();
        let groups = self.series.iter().filter(|s| s.mark.is_beside()).count();
        let lines = self.lines();
        let (mut group, mut line) = (0, 0);
        let mut above = Vec::new();
        for (series, ink) in self.series.iter().zip(inks) {
            let at = marks::Place { layout: &layout, panel: self, ink, group, groups, line, lines };
            out.push(at.group(series).into());
            above.extend(at.values(series));
            group += usize::from(series.mark.is_beside());
            line += usize::from(series.mark == Mark::Line);
        }
        out.extend(above);
        out
    }

    /// How many series are lines.
    fn lines(&self) -> usize {
        self.series.iter().filter(|s| s.mark == Mark::Line).count()
    }

    /// The ink of every series: its own, or its place.
    fn inks(&self) -> Vec<Ink> {
        let place = |(k, s): (usize, &Series)| s.ink.unwrap_or(Ink(k));
        self.series.iter().enumerate().map(place).collect()
    }

    /// Everything that must be seen, as it is placed.
    fn values(&self) -> impl Iterator<Item = (f64, f64)> {
        let placed = |p: (f64, f64)| (self.x.place(p.0), self.y.place(p.1));
        let ends = self.series.iter().flat_map(Series::corners).map(placed);
        ends.filter(|p| p.0.is_finite() && p.1.is_finite())
    }

    fn ranges(&self) -> (Range<f64>, Range<f64>) {
        let span = |values: &mut dyn Iterator<Item = f64>| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) = values.fold(ends, |(a, b), v| (a.min(v), b.max(v)));
            if low > high { (0.0, 1.0) } else { (low, high) }
        };
        let wide = |(low, high): (f64, f64), margin: f64| {
            let room = if high > low { margin * (high - low) } else { 0.05 * low.abs().max(1.0) };
            low - room..high + room
        };
        let rules = self.rules.iter().map(|r| self.y.place(r.at)).filter(|v| v.is_finite());
        let x = span(&mut self.values().map(|p| p.0));
        let y = span(&mut self.values().map(|p| p.1).chain(rules));
        let beside = self.series.iter().any(|s| matches!(s.mark, Mark::Bars | Mark::Steps));
        let across = if beside { x.0 - 0.6..x.1 + 0.6 } else { wide(x, 0.03) };
        let across = match self.x.names.len() {
            0 => across,
            names => 0.4..names as f64 + 0.6,
        };
        // Errors are seen from zero.
        if !self.y.log && !self.y.signed && y.0 >= 0.0 {
            return (across, 0.0..(y.1 * 1.1).max(f64::MIN_POSITIVE));
        }
        let bars = self.series.iter().any(|s| s.mark == Mark::Bars);
        if bars && !self.y.log {
            return (across, wide((y.0.min(0.0), y.1.max(0.0)), 0.06));
        }
        (across, wide(y, 0.06))
    }
}

/// Panels side by side, `columns` in a row, as a file.
#[must_use]
pub fn grid(panels: &[Panel], columns: usize) -> String {
    let columns = columns.clamp(1, panels.len().max(1));
    let size =
        panels.iter().fold((0.0_f64, 0.0_f64), |m, p| (m.0.max(p.size.0), m.1.max(p.size.1)));
    let rows = panels.len().div_ceil(columns).max(1);
    let (width, height) = (size.0 * columns as f64, size.1 * rows as f64);
    let mut root = element("svg")
        .with("xmlns", "http://www.w3.org/2000/svg")
        .with("class", "plot")
        .with("width", width)
        .with("height", height)
        .with("viewBox", format!("0 0 {width} {height}"))
        .child(element("style").child(Node::Code(STYLE)))
        .child(element("rect").with("class", "ground").with("width", width).with("height", height));
    for (k, panel) in panels.iter().enumerate() {
        let at = (size.0 * (k % columns) as f64, size.1 * (k / columns) as f64);
        let group = element("g").with("transform", format!("translate({} {})", at.0, at.1));
        root = root.child(group.children(panel.parts()));
    }
    format!("{root}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bars(y: Axis) -> String {
        let series =
            vec![Series::bars("a", &[0.21, 0.22, 0.23]), Series::bars("b", &[0.2, 0.2, 0.2])];
        let names = ["x", "y", "z"].map(str::to_owned).to_vec();
        Panel::new("t", Axis::names(names), y, series).svg()
    }

    /// On decades there is no zero for a bar to stand on.
    #[test]
    fn bars_on_decades_are_points() {
        let (log, linear) = (bars(Axis::log("mm")), bars(Axis::linear("mm")));
        assert_eq!(
            (log.matches("class=\"bar\"").count(), linear.matches("class=\"bar\"").count()),
            (0, 8)
        );
        assert_eq!(log.matches("class=\"shape\"").count(), 6 + 2);
        // Ticks, though no decade is within.
        assert!(log.contains(">0.21<") && log.contains(">0.22<"), "{log}");
    }

    #[test]
    fn marks_are_counted_and_said() {
        let many: Vec<f64> = (0..500).map(f64::from).collect();
        let text = Panel {
            series: vec![
                Series::points("many", numbered(&many)),
                Series::line("l", numbered(&many)),
            ],
            ..Panel::default()
        }
        .svg();
        assert_eq!(text.matches("data-marks=\"500\"").count(), 2);
        assert_eq!(text.matches("h0").count(), 500);
    }

    /// What lies on each other is drawn in different widths, and dashed.
    #[test]
    fn lines_on_each_other_can_be_told() {
        let line =
            |k: usize| Series::line(format!("{k}"), vec![(0.0, 1.0), (1.0, 2.0)]).ink(Ink(k));
        let text = Panel { series: (0..5).map(line).collect(), ..Panel::default() }.svg();
        let widths = ["4.4", "3.7", "3", "2.3", "1.6"];
        assert!(widths.iter().all(|w| text.contains(&format!("stroke-width=\"{w}\""))), "{text}");
    }

    #[test]
    fn names_are_escaped() {
        let text = Panel { title: "<b>&".to_owned(), ..Panel::default() }.svg();
        assert!(text.contains("&lt;b&gt;&amp;") && !text.contains("<b>"));
    }
}
