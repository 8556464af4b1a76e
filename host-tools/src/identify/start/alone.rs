//! Geometry alone, before anything else is asked of measurements.

use super::turned::first;
use crate::identify::fit::robust::{Flags, RobustFit, robust_fit};
use crate::identify::noise_estimate;
use crate::identify::problem::{Problem, Scaling};
use crate::model::{Measurements, Robot};

/// The arm fitted to measurements, gross errors left out.
pub struct Alone<'a> {
    /// With the noise that was found of each kind.
    pub problem: Problem<'a>,
    /// The fit.
    pub fit: RobustFit,
}

impl<'a> Alone<'a> {
    /// Of measurements; `None` where there is no fit of them.
    #[must_use]
    pub fn of(robot: &Robot, data: &'a Measurements) -> Option<Self> {
        let problem = Problem::rigid(data, robot, Scaling::Prior);
        let start = first(&problem, robot.tool).ok()?;
        let mut problem = problem.about(&start);
        let rows = problem.counted();
        problem.noise = noise_estimate::noise(&problem, &rows, &start).ok()?;
        let fit = robust_fit(&problem, &rows, &start, Flags::default()).ok()?;
        Some(Self { problem, fit })
    }
}
