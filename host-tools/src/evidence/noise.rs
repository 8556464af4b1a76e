use super::poses::Repeats;

/// Degrees of freedom of the prior of the noise scale: it is worth two
/// equations, and the scale itself is found again in every round.
pub const NU: f64 = 2.0;

/// Guard against a stale scatter of repeats: the scale cannot come out at less
/// than 0.7 of what all equations together say. Without repeats it is idle.
const LEAST: f64 = 0.5;
/// A gain of so many nats the guard never cuts: more than any effect costs. What is common
/// to repeats is structure at first, and half of it is little where poses are few: a
/// session of 37 poses read five times each had no name, and of the first reading of
/// each pose four.
const GAIN: f64 = 100.0;

/// The means of poses scatter by what their readings do at least, by this share of their
/// squares, as it is told by few. A search among hundreds of columns over twenty poses read
/// three times each found noise of a twentieth of that, and names for it.
const ROUGHLY: f64 = 0.5;

/// How much a sum of squares left over says: the noise scale integrated out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Equations that do not repeat a pose.
    pub(super) poses: f64,
    /// N: equations of their own pose, less those of geometry.
    pub(super) freedom: f64,
    /// Least share of all squares that a model can leave of the poses' own.
    least: f64,
    /// Squares of repeats about their pose's mean.
    repeats: f64,
    /// Squares of the poses' own that no model can go below.
    floor: f64,
    /// Of the squares left over, what geometry is off its nominal by, under its prior...
    prior: f64,
    /// ...which is no misfit, and of the others this share is at least.
    misfit: f64,
}

/// What geometry has used up of the equations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spent {
    /// Equations.
    pub freedom: f64,
    /// Squares: what it is off its nominal by, over the deviations of its prior.
    pub prior: f64,
}

impl Noise {
    #[must_use]
    pub(super) fn new(equations: usize, repeats: &Repeats, spent: Spent) -> Self {
        let (equations, repeated) = (equations as f64, repeats.equations as f64);
        let poses = equations - repeated;
        let freedom = (poses - spent.freedom).max(1.0);
        let share = freedom / (freedom + repeated);
        let least = share * LEAST.min((-2.0 * GAIN / freedom).exp());
        let floor = ROUGHLY * repeats.least * repeats.each() * freedom / poses.max(1.0);
        // Where the prior is right the squares of `poses` equations are as many, and those of
        // what geometry is off by as many as it uses up. Counted among those of the others they
        // made noise of 20 times what there is, in sessions of 13 poses.
        let misfit = (freedom / poses.max(1.0)).min(1.0);
        Self { poses, freedom, least, repeats: repeats.square, floor, prior: spent.prior, misfit }
    }

    /// Squares of the poses alone: repeats about their mean tell how readings
    /// scatter, not how poses do. A model that explains part of that scatter is
    /// not believed to leave next to nothing.
    pub(super) fn own(&self, rest: f64) -> f64 {
        let rest = rest.max(0.0);
        let poses = rest - self.repeats;
        (poses - self.prior).max(self.misfit * poses).max(self.least * rest).max(self.floor)
    }

    /// `-1/2 (nu + N) log(1 + rest / nu)`.
    pub(super) fn log_evidence(&self, rest: f64) -> f64 {
        -0.5 * (NU + self.freedom) * (self.own(rest) / NU).ln_1p()
    }
}
