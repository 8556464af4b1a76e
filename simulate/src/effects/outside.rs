//! What no report has a name for: a part of the cell errs as something goes that has
//! nothing to do with it. Each by its exact construction.

use nalgebra::{Rotation3, Vector3};

use crate::body::{Moment, Shape};

/// Which part, and what it goes with; joints are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outside {
    /// A hose pulls a joint as another one turns: rad.
    Hose { source: usize, joint: usize, order: f64, phase: f64 },
    /// The base leans `way` about its x and y as a joint turns: rad.
    Pedestal { joint: usize, order: f64, phase: f64, way: [f64; 2] },
    /// What holds the target gives way as a joint turns: m.
    Holder { joint: usize, order: f64, phase: f64, direction: Vector3<f64> },
    /// The disc of the tracker's azimuth is off its centre, or no circle: rad.
    Azimuth { order: f64, phase: f64 },
    /// The tracker's distances err in waves of a length in m: m.
    Distance { length: f64, phase: f64 },
    /// The zero of a joint goes with the temperature: rad per K.
    Warm { joint: usize },
}

impl Outside {
    /// Which part errs.
    pub fn part(&self) -> &'static str {
        match self {
            Self::Hose { .. } | Self::Warm { .. } => "joint",
            Self::Pedestal { .. } => "base",
            Self::Holder { .. } => "target",
            Self::Azimuth { .. } => "azimuth",
            Self::Distance { .. } => "distance",
        }
    }

    /// The joint that errs, counted from 1.
    pub fn joint(&self) -> Option<usize> {
        match self {
            Self::Hose { joint, .. } | Self::Warm { joint } => Some(joint + 1),
            _ => None,
        }
    }

    /// What it goes with, and of which joint, counted from 1.
    pub fn with(&self) -> (&'static str, Option<usize>) {
        match self {
            Self::Hose { source: joint, .. }
            | Self::Pedestal { joint, .. }
            | Self::Holder { joint, .. } => ("angle", Some(joint + 1)),
            Self::Azimuth { .. } => ("azimuth", None),
            Self::Distance { .. } => ("distance", None),
            Self::Warm { .. } => ("temperature", None),
        }
    }

    /// What it does to an arm that no load bends.
    pub(crate) fn displace(&self, size: f64, shape: &mut Shape, moment: &Moment) {
        let wave = |joint: usize, order: f64, phase: f64| (order * moment.q[joint] + phase).sin();
        match *self {
            Self::Hose { source, joint, order, phase } => {
                shape.joints[joint] += size * wave(source, order, phase);
            }
            Self::Warm { joint } => shape.joints[joint] += size * (moment.temperature - 20.0),
            Self::Pedestal { joint, order, phase, way } => {
                let lean = size * wave(joint, order, phase);
                shape.tilt.iter_mut().zip(way).for_each(|(tilt, way)| *tilt += lean * way);
            }
            _ => {}
        }
    }

    /// How it moves the target, in the frame of the last link.
    pub(crate) fn carried(&self, size: f64, moment: &Moment) -> Vector3<f64> {
        match *self {
            Self::Holder { joint, order, phase, direction } => {
                direction * (size * (order * moment.q[joint] + phase).sin())
            }
            _ => Vector3::zeros(),
        }
    }

    /// Where a tracker that stands at the origin, its axis upright, says that a point is.
    pub(crate) fn seen(&self, size: f64, point: Vector3<f64>) -> Vector3<f64> {
        match *self {
            Self::Azimuth { order, phase } => {
                let azimuth = point.y.atan2(point.x);
                let off = size * (order * azimuth + phase).sin();
                Rotation3::from_axis_angle(&Vector3::z_axis(), off) * point
            }
            Self::Distance { length, phase } => {
                let distance = point.norm();
                let off = size * (std::f64::consts::TAU * distance / length + phase).sin();
                point * (1.0 + off / distance)
            }
            _ => point,
        }
    }
}
