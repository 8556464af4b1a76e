//! Figures as SVG text: one or more panels of lines, points and bars.

mod axis;

pub use axis::Axis;

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use axis::Ticked;

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Joined points.
    Line,
    /// Points.
    Points,
    /// Bars side by side with those of the other series.
    Bars,
}

/// Values with one name.
#[derive(Debug, Clone)]
pub struct Series {
    /// In the legend; none if empty.
    pub name: String,
    /// x and y.
    pub points: Vec<(f64, f64)>,
    /// Look.
    pub mark: Mark,
}

impl Series {
    /// Joined points.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, mark: Mark::Line }
    }

    /// Points.
    pub fn points(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, mark: Mark::Points }
    }

    /// Bars at 1, 2, 3...
    pub fn bars(name: impl Into<String>, values: &[f64]) -> Self {
        Self { name: name.into(), points: numbered(values), mark: Mark::Bars }
    }
}

/// Values against 1, 2, 3...
#[must_use]
pub fn numbered(values: &[f64]) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(i, v)| (i as f64 + 1.0, *v)).collect()
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
    /// What is drawn.
    pub series: Vec<Series>,
}

/// Okabe and Ito's colours, which the colour-blind tell apart.
const COLOURS: [RGBColor; 9] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(80, 80, 80),
    RGBColor(160, 60, 60),
    RGBColor(0, 0, 0),
];
/// Width and height of a panel.
const SIZE: (u32, u32) = (760, 440);
/// Width of the names of the series at its right.
const KEY: u32 = 130;

impl Panel {
    /// The panel alone, as SVG.
    #[must_use]
    pub fn svg(&self) -> String {
        grid(std::slice::from_ref(self), 1)
    }

    fn values(&self) -> impl Iterator<Item = (f64, f64)> {
        let placed = |p: &(f64, f64)| (self.x.place(p.0), self.y.place(p.1));
        let all = self.series.iter().flat_map(move |s| s.points.iter().map(placed));
        all.filter(|p| p.0.is_finite() && p.1.is_finite())
    }

    fn ranges(&self) -> (Range<f64>, Range<f64>) {
        let span = |values: &mut dyn Iterator<Item = f64>| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) = values.fold(ends, |(a, b), v| (a.min(v), b.max(v)));
            if low > high { (0.0, 1.0) } else { (low, high) }
        };
        let wide = |(low, high): (f64, f64), margin: f64| {
            let room = margin * if high > low { high - low } else { low.abs().max(1.0) };
            low - room..high + room
        };
        let (x, y) = (span(&mut self.values().map(|p| p.0)), span(&mut self.values().map(|p| p.1)));
        let bars = self.series.iter().any(|s| s.mark == Mark::Bars);
        let across = if bars { x.0 - 0.6..x.1 + 0.6 } else { wide(x, 0.03) };
        // Errors are seen from zero.
        if !self.y.log && !self.y.signed && y.0 >= 0.0 {
            return (across, 0.0..(y.1 * 1.08).max(f64::MIN_POSITIVE));
        }
        if bars && !self.y.log {
            return (across, wide((y.0, y.1.max(0.0)), 0.06));
        }
        (across, wide(y, 0.06))
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let named = self.series.iter().any(|s| !s.name.is_empty());
        let (area, key) = match named {
            true => area.split_horizontally(SIZE.0 - KEY),
            false => (area.clone(), area.clone()),
        };
        let (across, up) = self.ranges();
        let (x_ticks, y_ticks) = (self.x.ticks(&across), self.y.ticks(&up));
        let bottom = up.start;
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, ("sans-serif", 17))
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(66)
            .build_cartesian_2d(
                Ticked { range: across, ticks: x_ticks.clone() },
                Ticked { range: up, ticks: y_ticks.clone() },
            )?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_labels(x_ticks.len())
            .y_labels(y_ticks.len())
            .x_label_formatter(&|v| self.x.tick(*v))
            .y_label_formatter(&|v| self.y.tick(*v))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style(("sans-serif", 13))
            .draw()?;
        let groups = self.series.iter().filter(|s| s.mark == Mark::Bars).count();
        let width = 0.8 / groups.max(1) as f64;
        let mut group = 0;
        for (series, colour) in self.series.iter().zip(COLOURS.iter().cycle()) {
            let placed = series.points.iter().map(|p| (self.x.place(p.0), self.y.place(p.1)));
            let placed: Vec<_> = placed.filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
            match series.mark {
                Mark::Line => chart.draw_series(LineSeries::new(placed, colour.stroke_width(2)))?,
                Mark::Points => {
                    chart.draw_series(placed.iter().map(|p| Circle::new(*p, 3, colour.filled())))?
                }
                Mark::Bars => {
                    let left = -0.4 + width * f64::from(group);
                    group += 1;
                    let foot = if self.y.log { bottom } else { 0.0 };
                    chart.draw_series(placed.iter().map(|(x, y)| {
                        let corners = [(x + left, foot), (x + left + width * 0.92, *y)];
                        Rectangle::new(corners, colour.filled())
                    }))?
                }
            };
        }
        let names = self.series.iter().zip(COLOURS.iter().cycle());
        for (k, (series, colour)) in names.filter(|(s, _)| !s.name.is_empty()).enumerate() {
            let y = 44 + 20 * k as i32;
            key.draw(&Rectangle::new([(0, y), (14, y + 10)], colour.filled()))?;
            let text = Text::new(series.name.as_str(), (20, y - 1), ("sans-serif", 13));
            key.draw(&text)?;
        }
        Ok(())
    }
}

/// Panels side by side, `columns` in a row, as SVG.
#[must_use]
pub fn grid(panels: &[Panel], columns: usize) -> String {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns).max(1);
    let mut out = String::new();
    {
        let size = (SIZE.0 * columns as u32, SIZE.1 * rows as u32);
        let area = SVGBackend::with_string(&mut out, size).into_drawing_area();
        let drawn = area.fill(&WHITE).and_then(|()| {
            let parts = area.split_evenly((rows, columns));
            panels.iter().zip(&parts).try_for_each(|(panel, part)| panel.draw(part))?;
            area.present()
        });
        // Text in memory takes whatever is drawn.
        drawn.unwrap_or_else(|e| unreachable!("drawing into a string: {e}"));
    }
    out
}
