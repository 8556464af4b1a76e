//! Where things stand in a panel: title, legend, axes with their ticks.

use std::ops::Range;

use super::strokes::{dashes, number, shape, text};
use super::{Mark, Panel};
use crate::markup::{Node, element};

/// Width of a character over the size of the font, about.
const WIDE: f64 = 0.56;
/// Size of the font.
const FONT: f64 = 13.0;
/// Most lines of a tick's name.
const MOST_LINES: usize = 4;

/// About how wide a text is.
pub(super) fn width(text: &str) -> f64 {
    WIDE * FONT * text.chars().count() as f64
}

/// A panel's axes and where they are.
pub(super) struct Layout {
    pub across: Range<f64>,
    pub up: Range<f64>,
    /// Left, top, right, bottom of what is drawn.
    pub edges: [f64; 4],
    x_ticks: Vec<(f64, Vec<String>)>,
    y_ticks: Vec<(f64, String)>,
    /// Series of the legend and where they stand.
    legend: Vec<(usize, f64, f64)>,
}

impl Layout {
    pub fn of(panel: &Panel) -> Self {
        let (width_all, height) = panel.size;
        let (mut across, mut up) = panel.ranges();
        let y_ticks = panel.y.ticks(&up, (height / 48.0) as usize);
        let widest = y_ticks.iter().map(|t| width(&t.1)).fold(0.0, f64::max);
        let named = if panel.y.label.is_empty() { 8.0 } else { 26.0 };
        let left = named + widest + 8.0;
        let right = width_all - 14.0;
        let (legend, below) = legend(panel, left, right);
        let top = below + 8.0;
        let x_ticks = panel.x.ticks(&across, ((right - left) / 70.0) as usize);
        let slot = (right - left) / panel.x.names.len().max(1) as f64;
        let x_ticks: Vec<(f64, Vec<String>)> = match panel.x.names.is_empty() {
            true => x_ticks.into_iter().map(|(at, text)| (at, vec![text])).collect(),
            false => x_ticks.into_iter().map(|(at, text)| (at, wrapped(&text, slot))).collect(),
        };
        let lines = x_ticks.iter().map(|t| t.1.len()).max().unwrap_or(1);
        let label = if panel.x.label.is_empty() { 4.0 } else { 22.0 };
        let bottom = height - 8.0 - label - 15.0 * lines as f64;
        if panel.equal {
            alike(&mut across, &mut up, (right - left) / (bottom - top));
        }
        let edges = [left, top, right, bottom];
        let mut layout = Self { across, up, edges, x_ticks, y_ticks, legend };
        if panel.equal {
            let (columns, rows) = ((right - left) / 70.0, height / 48.0);
            let ticks = panel.x.ticks(&layout.across, columns as usize);
            layout.x_ticks = ticks.into_iter().map(|(at, text)| (at, vec![text])).collect();
            layout.y_ticks = panel.y.ticks(&layout.up, rows as usize);
        }
        layout
    }

    /// From a placed x to the drawing.
    pub fn x(&self, value: f64) -> f64 {
        let [left, _, right, _] = self.edges;
        left + (value - self.across.start) / (self.across.end - self.across.start) * (right - left)
    }

    /// From a placed y to the drawing.
    pub fn y(&self, value: f64) -> f64 {
        let [_, top, _, bottom] = self.edges;
        bottom - (value - self.up.start) / (self.up.end - self.up.start) * (bottom - top)
    }

    /// Everything but the series.
    pub fn frame(&self, panel: &Panel) -> Vec<Node> {
        let mut out = Vec::new();
        if !panel.title.is_empty() {
            out.push(text(14.0, 22.0, &panel.title).with("class", "heading").into());
        }
        for (series, x, y) in &self.legend {
            out.extend(key(panel, *series, *x, *y));
        }
        out.extend(self.mesh(panel));
        out.extend(self.labels(panel));
        out.extend(panel.rules.iter().flat_map(|rule| self.rule(panel, rule)));
        out
    }

    fn mesh(&self, panel: &Panel) -> Vec<Node> {
        let [left, top, right, bottom] = self.edges.map(number);
        let mut lines = String::new();
        for (at, _) in &self.y_ticks {
            lines += &format!("M{left} {}H{right}", number(self.y(*at)));
        }
        if panel.x.names.is_empty() {
            for (at, _) in &self.x_ticks {
                lines += &format!("M{} {top}V{bottom}", number(self.x(*at)));
            }
        }
        let mut edge = format!("M{left} {top}V{bottom}H{right}");
        if !panel.y.log && self.up.start < 0.0 && self.up.end > 0.0 {
            edge += &format!("M{left} {}H{right}", number(self.y(0.0)));
        }
        let path = |class: &str, d: String| element("path").with("class", class).with("d", d);
        vec![path("mesh", lines).into(), path("edge", edge).into()]
    }

    fn labels(&self, panel: &Panel) -> Vec<Node> {
        let [left, top, right, bottom] = self.edges;
        let mut out: Vec<Node> = Vec::new();
        for (at, name) in &self.y_ticks {
            let tick = text(left - 6.0, self.y(*at) + 4.5, name).with("text-anchor", "end");
            out.push(tick.into());
        }
        for (at, lines) in &self.x_ticks {
            for (k, line) in lines.iter().enumerate() {
                let tick = text(self.x(*at), bottom + 16.0 + 15.0 * k as f64, line);
                out.push(tick.with("text-anchor", "middle").into());
            }
        }
        if !panel.x.label.is_empty() {
            let label = text((left + right) / 2.0, panel.size.1 - 8.0, &panel.x.label);
            out.push(label.with("text-anchor", "middle").into());
        }
        if !panel.y.label.is_empty() {
            let y = (top + bottom) / 2.0;
            let turned = text(15.0, y, &panel.y.label).with("text-anchor", "middle");
            out.push(turned.with("transform", format!("rotate(-90 15 {})", number(y))).into());
        }
        out
    }

    /// A line of reference with its name, above it unless that is outside.
    fn rule(&self, panel: &Panel, rule: &super::Rule) -> Vec<Node> {
        let [left, top, right, _] = self.edges;
        let y = self.y(panel.y.place(rule.at));
        if !y.is_finite() {
            return Vec::new();
        }
        let d = format!("M{} {}H{}", number(left), number(y), number(right));
        let line = element("path").with("class", "rule").with("d", d);
        let above = if y - 16.0 < top { y + 15.0 } else { y - 5.0 };
        let name = text(left + 6.0, above, &rule.name);
        vec![line.into(), name.with("class", "halo small").into()]
    }
}

/// A name in the legend with what its marks look like.
fn key(panel: &Panel, which: usize, x: f64, y: f64) -> Vec<Node> {
    let (series, ink) = (&panel.series[which], panel.inks()[which].place());
    let dashed = panel.lines() > 1;
    let group = element("g").with("class", format!("key i{ink}"));
    let bar = |h: f64| format!("M{} {}h16v{h}h-16z", number(x), number(y - 4.5 - h / 2.0));
    let mark = |class: &str, d: String| element("path").with("class", class).with("d", d);
    let flat = format!("M{} {}h16", number(x), number(y - 4.5));
    let drawn = match series.mark {
        Mark::Line if dashed => {
            mark("line", flat).with("stroke-width", 2.5).with("stroke-dasharray", dashes(ink))
        }
        Mark::Line => mark("line", flat).with("stroke-width", 2.5),
        Mark::Arrows => mark("thin", flat),
        Mark::Steps => mark("tread", flat),
        Mark::Band => mark("band", bar(12.0)),
        Mark::Bars if !panel.y.log => mark("bar", bar(10.0)),
        Mark::Points | Mark::Intervals | Mark::Bars => mark("shape", shape(ink, x + 8.0, y - 4.5)),
    };
    vec![group.child(drawn).into(), text(x + 22.0, y, &series.name).into()]
}

/// Where the names of the series stand, in rows; and where they end.
fn legend(panel: &Panel, left: f64, right: f64) -> (Vec<(usize, f64, f64)>, f64) {
    let first = if panel.title.is_empty() { 16.0 } else { 44.0 };
    let (mut x, mut y) = (left, first);
    let mut out = Vec::new();
    for (k, series) in panel.series.iter().enumerate().filter(|(_, s)| !s.name.is_empty()) {
        let wide = 22.0 + width(&series.name) + 18.0;
        if x > left && x + wide > right + 18.0 {
            (x, y) = (left, y + 18.0);
        }
        out.push((k, x, y));
        x += wide;
    }
    let below = if out.is_empty() { first - 12.0 } else { y };
    (out, below)
}

/// A name in as many lines as its slot asks for, broken after blanks and hyphens.
fn wrapped(name: &str, slot: f64) -> Vec<String> {
    let mut lines: Vec<String> = vec![String::new()];
    for part in name.split_inclusive([' ', '-']) {
        let last = lines.len() - 1;
        let longer = format!("{}{part}", lines[last]);
        if lines[last].is_empty() || width(longer.trim_end()) <= slot - 6.0 {
            lines[last] = longer;
        } else {
            lines.push(part.to_owned());
        }
    }
    lines.truncate(MOST_LINES);
    lines.into_iter().map(|line| line.trim_end().to_owned()).collect()
}

/// Makes the narrower range so wide that units are as long across as up.
fn alike(across: &mut Range<f64>, up: &mut Range<f64>, aspect: f64) {
    let (x, y) = (across.end - across.start, up.end - up.start);
    let more =
        |range: &mut Range<f64>, by: f64| *range = range.start - by / 2.0..range.end + by / 2.0;
    if x < y * aspect {
        more(across, y * aspect - x);
    } else {
        more(up, x / aspect - y);
    }
}
