//! What series look like.

use super::frame::Layout;
use super::strokes::{dashes, number, shape, text};
use super::{Ink, Mark, Panel, Series};
use crate::markup::{Element, Node, element};

/// Points from which on they are dots of one path, without shapes and notes.
const MANY: usize = 300;
/// Share of its slot that a group of marks takes.
const WIDTH: f64 = 0.84;
/// A series in its panel.
pub(super) struct Place<'a> {
    pub layout: &'a Layout,
    pub panel: &'a Panel,
    pub ink: Ink,
    /// Which of those beside each other.
    pub group: usize,
    pub groups: usize,
    /// Which of the lines.
    pub line: usize,
    pub lines: usize,
}

/// A mark: its first corner, the further ones, its note.
struct Seen<'s> {
    at: (f64, f64),
    ends: Option<(f64, f64)>,
    note: Option<&'s str>,
    value: f64,
}

impl Place<'_> {
    /// The series as a group.
    pub fn group(&self, series: &Series) -> Element {
        let seen = self.seen(series);
        let marks = seen.len();
        let drawn: Vec<Node> = match series.mark {
            Mark::Line => vec![self.line(&seen).into()],
            Mark::Points if marks > MANY => vec![dots(&seen).into()],
            Mark::Points => seen.iter().map(|s| self.shape(s)).collect(),
            Mark::Bars if self.panel.y.log => seen.iter().map(|s| self.shape(s)).collect(),
            Mark::Bars => seen.iter().map(|s| self.bar(s)).collect(),
            Mark::Intervals => seen.iter().flat_map(|s| self.interval(s)).collect(),
            Mark::Band => vec![band(&seen).into()],
            Mark::Steps => self.steps(&seen),
            Mark::Arrows => vec![arrows(&seen).into()],
        };
        element("g")
            .with("class", format!("series i{}", self.ink.place()))
            .with("data-marks", marks)
            .children(drawn)
    }

    /// Marks where they are drawn; values that no axis has are left out.
    fn seen<'s>(&self, series: &'s Series) -> Vec<Seen<'s>> {
        let width = WIDTH / self.groups.max(1) as f64;
        let aside = match series.mark.is_beside() {
            true => width * (self.group as f64 + 0.5) - WIDTH / 2.0,
            false => 0.0,
        };
        let (x, y) = (&self.panel.x, &self.panel.y);
        let of = |(k, p): (usize, &(f64, f64))| {
            let at = (self.layout.x(x.place(p.0) + aside), self.layout.y(y.place(p.1)));
            let ends = series.ends.get(k).map(|e| match series.mark {
                Mark::Arrows => (self.layout.x(x.place(e.0)), self.layout.y(y.place(e.1))),
                _ => (self.layout.y(y.place(e.0)), self.layout.y(y.place(e.1))),
            });
            let note = series.notes.get(k).map(String::as_str);
            let finite = at.0.is_finite() && at.1.is_finite();
            finite.then_some(Seen { at, ends, note, value: p.1 })
        };
        series.points.iter().enumerate().filter_map(of).collect()
    }

    /// Lines that lie on each other are of different widths, the later thinner.
    fn line(&self, seen: &[Seen]) -> Element {
        let below = self.lines.saturating_sub(self.line + 1) as f64;
        let many = self.lines > 3;
        let width = if many { 1.6 + 0.7 * below.min(8.0) } else { 2.2 };
        let mut d = String::new();
        for (k, s) in seen.iter().enumerate() {
            let pen = if k == 0 { 'M' } else { 'L' };
            d += &format!("{pen}{} {}", number(s.at.0), number(s.at.1));
        }
        let path = element("path").with("class", "line").with("d", d);
        let path = path.with("stroke-width", number(width));
        // A line alone need not be told from others.
        match self.lines {
            0 | 1 => path,
            _ => path.with("stroke-dasharray", dashes(self.ink.place())),
        }
    }

    fn shape(&self, s: &Seen) -> Node {
        let d = shape(self.ink.place(), s.at.0, s.at.1);
        noted(element("path").with("class", "shape").with("d", d), s)
    }

    fn bar(&self, s: &Seen) -> Node {
        let slot = self.layout.x(1.0) - self.layout.x(0.0);
        let width = (0.78 * slot / self.groups.max(1) as f64).max(0.5);
        let foot = self.layout.y(0.0);
        let bar = element("rect")
            .with("class", "bar")
            .with("x", number(s.at.0 - width / 2.0))
            .with("y", number(s.at.1.min(foot)))
            .with("width", number(width))
            .with("height", number((s.at.1 - foot).abs().max(0.5)));
        noted(bar, s)
    }

    fn interval(&self, s: &Seen) -> Option<Node> {
        let (low, high) = s.ends?;
        let (x, cap) = (s.at.0, 4.0);
        let (from, to) = (number(x - cap), number(x + cap));
        let (low, high) = (number(low), number(high));
        let d = format!("M{from} {low}H{to}M{from} {high}H{to}M{} {low}V{high}", number(x));
        let bar = element("path").with("class", "thin").with("d", d);
        Some(element("g").child(bar).child(self.shape(s)).into())
    }

    /// Treads, and the risers between them.
    fn steps(&self, seen: &[Seen]) -> Vec<Node> {
        let slot = self.layout.x(1.0) - self.layout.x(0.0);
        let half = 0.5 * WIDTH * slot / self.groups.max(1) as f64 - 3.0;
        let mut out: Vec<Node> = Vec::new();
        for pair in seen.windows(2) {
            let (from, to) = (pair[0].at, pair[1].at);
            let (start, end) = (number(from.0 + half), number(to.0 - half));
            let d = format!("M{start} {}H{end}V{}", number(from.1), number(to.1));
            out.push(element("path").with("class", "riser").with("d", d).into());
        }
        for s in seen {
            let (x, y) = s.at;
            let d = format!("M{} {}h{}", number(x - half), number(y), number(2.0 * half));
            out.push(noted(element("path").with("class", "tread").with("d", d), s));
        }
        out
    }

    /// What stands above the marks of all series: the values of treads.
    pub fn values(&self, series: &Series) -> Vec<Node> {
        if series.mark != Mark::Steps {
            return Vec::new();
        }
        let [_, top, ..] = self.layout.edges;
        let value = |s: &Seen| {
            let (x, y) = s.at;
            let at = if y < top + 18.0 { y + 17.0 } else { y - 7.0 };
            let value = text(x, at, &significant(s.value)).with("text-anchor", "middle");
            value.with("class", "halo small").into()
        };
        self.seen(series).iter().map(value).collect()
    }
}

/// Three digits.
fn significant(value: f64) -> String {
    let size = value.abs().max(1e-9).log10().floor();
    format!("{value:.*}", (2.0 - size).clamp(0.0, 6.0) as usize)
}

fn noted(mark: Element, s: &Seen) -> Node {
    match s.note {
        Some(note) => mark.child(element("title").text(note)).into(),
        None => mark.into(),
    }
}

fn dots(seen: &[Seen]) -> Element {
    let mut d = String::new();
    seen.iter().for_each(|s| d += &format!("M{} {}h0", number(s.at.0), number(s.at.1)));
    element("path").with("class", "dots").with("d", d)
}

fn arrows(seen: &[Seen]) -> Element {
    let mut d = String::new();
    for s in seen {
        let (x, y) = s.ends.unwrap_or(s.at);
        d += &format!("M{} {}L{} {}", number(s.at.0), number(s.at.1), number(x), number(y));
    }
    element("path").with("class", "thin").with("d", d)
}

fn band(seen: &[Seen]) -> Element {
    let mut d = String::new();
    let ends = seen.iter().filter_map(|s| s.ends.map(|e| (s.at.0, e)));
    let both: Vec<(f64, (f64, f64))> = ends.collect();
    for (k, (x, (low, _))) in both.iter().enumerate() {
        d += &format!("{}{} {}", if k == 0 { 'M' } else { 'L' }, number(*x), number(*low));
    }
    for (x, (_, high)) in both.iter().rev() {
        d += &format!("L{} {}", number(*x), number(*high));
    }
    if !d.is_empty() {
        d.push('Z');
    }
    element("path").with("class", "band").with("d", d)
}
