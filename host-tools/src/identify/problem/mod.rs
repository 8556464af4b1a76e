//! The measured rows as a least-squares problem.

pub mod accumulate;
mod cell;
mod conditions;
mod linearised;
mod motion;
mod noise;
mod predictor;
mod scatterer;
mod targets;
mod unknowns;

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use truearm::{Link, MdhParameters};

pub use cell::Cell;
pub use conditions::{Conditions, Surroundings};
pub use linearised::{Equations, Linearised};
pub use motion::{Beside, moving};
pub(crate) use noise::{Group, groups};
pub use noise::{Noise, in_deviations};
pub use predictor::{Model as Predictor, View, measurement_column};
pub use scatterer::{Place, Scatterer};
pub use targets::{Target, Turns, firmness, spreads, spreads_of};
pub use unknowns::{Layout, State, TOLERANCE_ANGLE, TOLERANCE_LENGTH, Unit, Unknown, Unknowns};

use crate::model::{LinkPrior, Measurements, Robot, Values};
use crate::observations::{self, equations_of, kind};

/// What lambda weighs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scaling {
    /// Residuals count standard deviations, parameters count tolerances:
    /// lambda = 1 is the maximum a posteriori estimate.
    #[default]
    Prior,
    /// `lambda I` on metres and radians, as the paper prints it.
    Printed,
}

/// A data set and its unknowns.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// The measurements.
    pub data: &'a Measurements,
    /// What terms depend on, row by row.
    pub conditions: Arc<Conditions>,
    /// Nominal links.
    pub nominal: Vec<Link<f64>>,
    /// What their corrections are kept near, and how near.
    pub priors: Vec<LinkPrior>,
    /// Column order.
    pub unknowns: Unknowns,
    /// What lambda weighs.
    pub scaling: Scaling,
    /// By how much each kind is noisier than stated.
    pub noise: Noise,
    /// What scatters by itself, and by how much, rad or m (one standard deviation): a part of
    /// the stated noise that is along the way it moves targets.
    pub scattering: Vec<(Scatterer, f64)>,
    /// Where the targets sit by registration, and how firmly; empty where nothing holds them.
    pub targets: Vec<Target>,
    /// What each row is off by for a reason that no unknown stands for, SI; empty where there
    /// is none.
    pub aside: Arc<Vec<Values>>,
    /// Where rows were measured, by registration.
    pub cell: Arc<Cell>,
}

impl<'a> Problem<'a> {
    /// Of all rows of `data`, geometry only.
    #[must_use]
    pub fn new(data: &'a Measurements, robot: &Robot, scaling: Scaling) -> Self {
        Self::under(data, robot, scaling, Conditions::new(data, robot))
    }

    /// The same of an arm that no term moves: nothing of what terms depend on is known.
    #[must_use]
    pub fn rigid(data: &'a Measurements, robot: &Robot, scaling: Scaling) -> Self {
        Self::under(data, robot, scaling, Conditions::rigid())
    }

    /// The same under conditions that are known.
    #[must_use]
    pub fn under(
        data: &'a Measurements,
        robot: &Robot,
        scaling: Scaling,
        conditions: Conditions,
    ) -> Self {
        let nominal = robot.nominal();
        let conditions = Arc::new(conditions);
        let unknowns = Unknowns::of(&Layout::of(data), 0, nominal.len());
        let (noise, scattering, targets) = (Noise::default(), Vec::new(), Vec::new());
        let priors = robot.joints.iter().map(|joint| joint.prior).collect();
        let (aside, cell) = (Arc::default(), Arc::default());
        Self {
            data,
            conditions,
            nominal,
            priors,
            unknowns,
            scaling,
            noise,
            scattering,
            targets,
            aside,
            cell,
        }
    }

    /// The same with targets and what they are measured with about where a state has them.
    #[must_use]
    pub fn about(self, start: &State) -> Self {
        let targets = targets::of(self.data, &self.nominal, &start.markers);
        let cell = Arc::new(Cell::about(self.data, &self.conditions, start));
        Self { targets, cell, ..self }
    }

    /// Rows that measure something, once where they were written several times:
    /// nothing is measured twice to the last digit.
    #[must_use]
    pub fn counted(&self) -> Vec<usize> {
        let mut rows = self.data.distinct();
        rows.retain(|row| equations_of(&self.data.rows[*row]) > 0);
        rows
    }

    /// Equations `[A, b]` that hold the targets of a state about their registration.
    #[must_use]
    pub fn of_targets(&self, state: &State) -> DMatrix<f64> {
        let columns = self.unknowns.list().len();
        let mut rows = DMatrix::zeros(3 * self.targets.len(), columns + 1);
        for (m, target) in self.targets.iter().enumerate() {
            let Some(first) = self.unknowns.marker(m) else { continue };
            let off = target.firmness * (target.place - state.markers[m]);
            for k in 0..3 {
                let unit = self.unit(Unknown::Marker(m, k));
                let column = target.firmness.column(k) * unit;
                rows.fixed_view_mut::<3, 1>(3 * m, first + k).copy_from(&column);
                rows[(3 * m + k, columns)] = off[k];
            }
        }
        rows
    }

    /// The same with so many terms.
    #[must_use]
    pub fn with_terms(&self, terms: usize) -> Self {
        let unknowns = Unknowns::of(&Layout::of(self.data), terms, self.nominal.len());
        Self { unknowns, ..self.clone() }
    }

    /// Size of one unit of each unknown, m or rad.
    #[must_use]
    pub fn unit(&self, unknown: Unknown) -> f64 {
        match (self.scaling, unknown) {
            (Scaling::Printed, Unknown::Link(..)) => 1.0,
            _ => self.tolerance(unknown),
        }
    }

    /// One tolerance of an unknown, m or rad: that of the arm's type, where it is known.
    #[must_use]
    pub fn tolerance(&self, unknown: Unknown) -> f64 {
        self.stated(unknown).unwrap_or_else(|| unknown.tolerance())
    }

    /// The same where robot.toml states one.
    #[must_use]
    pub fn stated(&self, unknown: Unknown) -> Option<f64> {
        match unknown {
            Unknown::Link(joint, parameter) => self.priors[joint].tolerance[parameter as usize],
            _ => None,
        }
    }

    /// All units in column order.
    #[must_use]
    pub fn units(&self) -> DVector<f64> {
        let list = self.unknowns.list();
        DVector::from_fn(list.len(), |k, _| self.unit(list[k]))
    }

    /// SI to one unit of each equation of a row.
    #[must_use]
    pub fn scale(&self, row: usize) -> Values {
        let sigmas = self.noise.sigmas(&self.data.rows[row]);
        match self.scaling {
            Scaling::Prior => sigmas,
            Scaling::Printed => sigmas.map(|_| 1.0),
        }
    }

    /// The factor that makes each equation of a row say how far off it is, m; 0 of
    /// those that do not count.
    #[must_use]
    pub fn in_metres(&self, row: usize) -> Values {
        let (of, scale) = (kind(&self.data.rows[row]), self.scale(row));
        let alone = |c: usize| Values::from_fn(scale.len(), |k| f64::from(u8::from(k == c)));
        Values::from_fn(scale.len(), |c| scale[c] * of.miss(&alone(c)))
    }

    /// How many equations some rows give.
    #[must_use]
    pub fn equations(&self, rows: &[usize]) -> usize {
        observations::equations(&self.data.rows, rows)
    }

    /// The correction that is expected of an unknown, m or rad.
    #[must_use]
    pub fn expected(&self, unknown: Unknown) -> f64 {
        match unknown {
            Unknown::Link(joint, parameter) => self.priors[joint].expected[parameter as usize],
            _ => 0.0,
        }
    }

    /// Corrections of a state beyond those that are expected, in units; zero for the
    /// free unknowns.
    #[must_use]
    pub fn corrections(&self, state: &State) -> DVector<f64> {
        let mut x = DVector::zeros(self.unknowns.list().len());
        for (i, (link, nominal)) in state.links.iter().zip(&self.nominal).enumerate() {
            let (now, then) = (link.parameters.to_array(), nominal.parameters.to_array());
            for k in 0..5 {
                let at = self.unknowns.free() + 5 * i + k;
                let off = now[k] - then[k] - self.priors[i].expected[k];
                x[at] = off / self.unit(self.unknowns.list()[at]);
            }
        }
        x
    }
}

/// Corrections of a state as link parameters.
#[must_use]
pub fn link_corrections(state: &State, nominal: &[Link<f64>]) -> Vec<MdhParameters<f64>> {
    let difference = |(link, nominal): (&Link<f64>, &Link<f64>)| {
        let (now, then) = (link.parameters.to_array(), nominal.parameters.to_array());
        MdhParameters::from_array(core::array::from_fn(|k| now[k] - then[k]))
    };
    state.links.iter().zip(nominal).map(difference).collect()
}
