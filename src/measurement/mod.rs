//! What was measured of the tool point on the running arm: its coordinates, a touch of a
//! plane, a distance. What [`crate::streaming`] and [`crate::reidentify`] take.
//!
//! | reading | says | equations |
//! |---|---|---|
//! | [`Reading::Point`] | where the tool point is: a tracker | 3 |
//! | [`Reading::Height`] | how high it is above a [`Plane`]: a touch with a ball, a dial gauge | 1 |
//! | [`Reading::Distance`] | how far it is from an [`Anchor`]: a ballbar, a draw wire, a touch of a sphere | 1 |
//!
//! A [`CheckPoint`] is a measurement of the first kind and is taken wherever one is.
//! Planes and anchors are in the frame of the points: the commanded frame, or that of a
//! tracker whose place is unknown.
//!
//! **Of unknown place.** A plane or an anchor that is only near where it is stated to be
//! ([`Plane::unknown`]) is found with the arm: its parameters
//! ([`Parameter::plane`], [`Parameter::anchor`]) stand in the list of unknowns like those
//! of a tracker. They are of the measurement, not of the arm: fitted and never stored.
//! [`Plane::found`] is the plane where it then was.
//!
//! **What touches leave open.** Touches of a known plane say nothing of what moves the
//! tool along it: how the arm turns about its normal, how it shifts in it. Touches of
//! planes of unknown place fix no length either: an arm twice as large in front of planes
//! twice as far touches the same, and where the arm stands is not seen. Nothing of this is
//! guessed. The prior holds what the measurements leave open (the paper's Eq. 11,
//! `|U x - S|^2 + lambda |x|^2`, with a scale for every parameter), and `determined` and
//! `rank` of a result say which that is: read them before parameters are stored. What
//! closes it is another plane, a distance, a point.
//!
//! **What one wrong reading does.** As much as a right one, and `determined`, `rank` and sigma,
//! which are of where the arm stood, do not show it: the [`misfit`](crate::solve::Misfit) of a
//! result does, and what contradicts the stated noise is refused. Take readings to spare: as
//! many equations as unknowns agree with anything.
//!
//! ```
//! use truearm::measurement::Plane;
//! use truearm::nalgebra::Vector3;
//! use truearm::parameters::{Axis, Parameter};
//! use truearm::reidentify::Reidentify;
//! use truearm::{Arm6, blob::Blob};
//!
//! # fn main() -> Result<(), Box<dyn core::error::Error>> {
//! # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
//! let stored = Blob::check(slot)?.parameters::<f64, 6>()?;
//! # let arm = Arm6::new(&stored);
//! // A table, about: its offset and how it leans are to be found. A ball of 3 mm.
//! let table = Plane::new(Vector3::new(-0.6, 0.2, -0.1), Vector3::new(0.0, 0.0, 1.0))?.unknown(0);
//! let touches = [0.0, 0.3, 0.6, 0.9, 1.2].map(|turn| {
//!     let q = [turn, -1.2, 1.6 - 0.1 * turn, -1.2, -1.57, 0.8];
//! #   // How high the tool is above a table that leans by 2 mrad, and lies 1 mm lower.
//! #   let p = arm.real_pose(&q).translation - Vector3::new(-0.6, 0.2, -0.101);
//! #   let reading = p.z - 2e-3 * p.x;
//!     table.touched(q, reading, stored.reference_temperature)
//! });
//! let unknowns = Parameter::plane(0, Axis::Z);
//! let found = Reidentify::new(&stored, unknowns, 10e-6).run(&stored, &touches)?;
//! let table = table.found(&unknowns, &found.change);
//! assert!((table.normal().x + 2e-3).abs() < 1e-5, "it leans by 2 mrad");
//! # Ok(())
//! # }
//! ```

mod anchor;
mod equations;
mod error;
mod modelled;
mod plane;

use nalgebra::Vector3;

pub use anchor::Anchor;
pub(crate) use equations::{Equations, Unknowns};
pub use error::{MeasurementError, PlaneError};
use modelled::{Modelled, Moved, Rest};
pub use plane::Plane;

use crate::arm::{Arm, State};
use crate::check_point::CheckPoint;
use crate::kinematics::dot;
use crate::parameters::Parameter;
use crate::scalar::Scalar;

/// What was read of the tool point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reading<T> {
    /// Its coordinates, m.
    Point(#[cfg_attr(feature = "defmt", defmt(Debug2Format))] Vector3<T>),
    /// Its height above a plane, m, on the side that the normal points to: of a touch
    /// the radius of the ball whose centre the tool point is, of a gauge what it shows.
    Height {
        /// The plane.
        plane: Plane<T>,
        /// m
        height: T,
    },
    /// Its distance from an anchor, m, all constant lengths of the instrument included:
    /// of a touched sphere the sum of both radii.
    Distance {
        /// The anchor.
        anchor: Anchor<T>,
        /// m
        distance: T,
    },
}

/// A measurement: how the arm stood, and what was read.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Measurement<T, const N: usize> {
    /// Encoder readings, rad or m.
    pub q: [T; N],
    /// Approach, payload, temperature and torques at the measurement.
    pub state: State<T, N>,
    /// What was read.
    pub reading: Reading<T>,
}

impl<T, const N: usize> From<CheckPoint<T, N>> for Measurement<T, N> {
    #[inline]
    fn from(point: CheckPoint<T, N>) -> Self {
        Self { q: point.q, state: point.state, reading: Reading::Point(point.point) }
    }
}

impl<T: Scalar, const N: usize> Measurement<T, N> {
    /// How many equations it gives.
    #[must_use]
    pub fn equations(&self) -> u32 {
        match self.reading {
            Reading::Point(_) => 3,
            Reading::Height { .. } | Reading::Distance { .. } => 1,
        }
    }

    /// Whether it can be taken when these are the unknowns.
    #[inline]
    pub(crate) fn check(&self, parameters: &[Parameter]) -> Result<(), MeasurementError> {
        let finite = self.q.iter().chain(self.state.numbers()).all(|v| v.is_finite());
        if !(finite && self.reading.is_finite()) {
            return Err(MeasurementError::NotFinite);
        }
        let chosen = || parameters.iter().any(|parameter| self.reading.has(*parameter));
        match self.reading.label() {
            Some(_) if !chosen() => Err(MeasurementError::PlaceNotChosen),
            _ => Ok(()),
        }
    }

    /// Where the model sees the tool point, m, in the commanded frame.
    pub(crate) fn predicted(&self, arm: &Arm<T, N>) -> Vector3<T> {
        arm.real_pose_in(&self.q, &self.state).translation
    }
}

impl<T: Scalar> Reading<T> {
    #[inline]
    fn is_finite(&self) -> bool {
        match self {
            Self::Point(point) => point.iter().all(|v| v.is_finite()),
            // No plane has been made of anything else.
            Self::Height { height, .. } => height.is_finite(),
            Self::Distance { anchor, distance } => anchor.is_finite() && distance.is_finite(),
        }
    }

    /// Of its plane's or anchor's place if that is unknown.
    fn label(&self) -> Option<u8> {
        match self {
            Self::Point(_) => None,
            Self::Height { plane, .. } => plane.label(),
            Self::Distance { anchor, .. } => anchor.label(),
        }
    }

    /// Whether it is a parameter of that place.
    fn has(&self, parameter: Parameter) -> bool {
        match self {
            Self::Point(_) => false,
            Self::Height { plane, .. } => plane.has(parameter),
            Self::Distance { anchor, .. } => anchor.has(parameter),
        }
    }

    /// What it is beyond the model of a tool point in its frame; planes and anchors of
    /// unknown place are where `change` of `parameters` has them.
    #[inline(always)]
    fn rest(&self, point: &Vector3<T>, parameters: &[Parameter], change: &[T]) -> Rest<T> {
        let moved = || Moved::by(parameters, change, |parameter| self.has(parameter));
        match self {
            Self::Point(measured) => Rest::Point(measured - point),
            Self::Height { plane, height } => {
                let modelled = plane.modelled(point, &moved());
                Rest::Number(*height - modelled.value, modelled)
            }
            Self::Distance { anchor, distance } => {
                let modelled = anchor.modelled(point, &moved());
                Rest::Number(*distance - modelled.value, modelled)
            }
        }
    }

    /// Square of how far that is, m^2.
    #[inline]
    pub(crate) fn miss_square(
        &self,
        point: &Vector3<T>,
        parameters: &[Parameter],
        change: &[T],
    ) -> T {
        match self.rest(point, parameters, change) {
            Rest::Point(rest) => dot(&rest, &rest),
            Rest::Number(rest, _) => rest * rest,
        }
    }
}
