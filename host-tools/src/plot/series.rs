//! Values with one name, and how they look.

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Joined points.
    Line,
    /// Points.
    Points,
    /// Bars side by side with those of the other series; points on an axis of
    /// decades, which has no foot for a bar to stand on.
    Bars,
    /// Points with the ends of their intervals, side by side.
    Intervals,
    /// From low to high along x, filled.
    Band,
    /// Treads of a stair at 1, 2, 3..., each with its value.
    Steps,
    /// From a point to its end.
    Arrows,
}

impl Mark {
    /// Whether several series stand beside each other.
    pub(super) fn is_beside(self) -> bool {
        matches!(self, Self::Bars | Self::Intervals | Self::Steps)
    }
}

/// A colour with its shape and dashes: one number means the same in all figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ink(pub usize);

impl Ink {
    /// What is held out, or after.
    pub const AFTER: Self = Self(0);
    /// What is nominal, or before.
    pub const BEFORE: Self = Self(1);
    /// What was fitted.
    pub const FITTED: Self = Self(2);
    /// What a model says.
    pub const MODEL: Self = Self(3);
    /// What was measured, where there is nothing else to tell.
    pub const DATA: Self = Self(6);

    /// One of the ten that there are.
    pub(super) fn place(self) -> usize {
        self.0 % 10
    }
}

/// Values with one name.
#[derive(Debug, Clone)]
pub struct Series {
    /// In the legend; none if empty.
    pub name: String,
    /// x and y.
    pub points: Vec<(f64, f64)>,
    /// Of intervals and bands low and high, of arrows the end; else none.
    pub ends: Vec<(f64, f64)>,
    /// What a mark is, one each, where somebody points at it; may be empty.
    pub notes: Vec<String>,
    /// Look.
    pub mark: Mark,
    /// Colour; of its place among the series without.
    pub ink: Option<Ink>,
}

impl Series {
    /// Of points.
    pub fn new(name: impl Into<String>, points: Vec<(f64, f64)>, mark: Mark) -> Self {
        Self { name: name.into(), points, ends: Vec::new(), notes: Vec::new(), mark, ink: None }
    }

    /// Joined points.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, points, Mark::Line)
    }

    /// Points.
    pub fn points(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, points, Mark::Points)
    }

    /// Bars at 1, 2, 3...
    pub fn bars(name: impl Into<String>, values: &[f64]) -> Self {
        Self::new(name, numbered(values), Mark::Bars)
    }

    /// In a colour of its own.
    #[must_use]
    pub fn ink(self, ink: Ink) -> Self {
        Self { ink: Some(ink), ..self }
    }

    /// With ends: see [`Series::ends`].
    #[must_use]
    pub fn ends(self, ends: Vec<(f64, f64)>) -> Self {
        Self { ends, ..self }
    }

    /// With what each mark is.
    #[must_use]
    pub fn notes(self, notes: Vec<String>) -> Self {
        Self { notes, ..self }
    }

    /// Every corner that a drawing of it reaches.
    pub(super) fn corners(&self) -> Vec<(f64, f64)> {
        let mut out = self.points.clone();
        match self.mark {
            Mark::Intervals | Mark::Band => {
                let both = self.points.iter().zip(&self.ends);
                out.extend(both.flat_map(|(p, end)| [(p.0, end.0), (p.0, end.1)]));
            }
            Mark::Arrows => out.extend(&self.ends),
            _ => {}
        }
        out
    }
}

/// Values against 1, 2, 3...
#[must_use]
pub fn numbered(values: &[f64]) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(i, v)| (i as f64 + 1.0, *v)).collect()
}
