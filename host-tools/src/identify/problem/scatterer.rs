//! What scatters beside the noise that rows state.

use nalgebra::Vector3;

/// What may scatter by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scatterer {
    /// A joint, counted from 0: its angle, rad, or its way, m.
    Joint(usize),
    /// The line of sight from a place in a station's coordinates: its angles, rad, so that a
    /// point is read the worse the farther away it is, across that line.
    Sight(Place),
    /// The distance from such a place, so that a point is read the worse the farther away it is,
    /// along that line; 1 is as much as the distance itself.
    Range(Place),
}

/// Where an instrument stands in the coordinates of its points, mm: nearer than what tells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place([i32; 3]);

impl Place {
    /// Where coordinates begin.
    pub const ORIGIN: Self = Self([0; 3]);

    /// The nearest to a point, m.
    #[must_use]
    pub fn near(point: &Vector3<f64>) -> Self {
        Self([0, 1, 2].map(|axis| (point[axis] * 1e3).round() as i32))
    }

    /// The point, m.
    #[must_use]
    pub fn point(self) -> Vector3<f64> {
        Vector3::from(self.0.map(|mm| f64::from(mm) * 1e-3))
    }
}

impl Scatterer {
    /// The joint, counted from 0.
    #[must_use]
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Joint(joint) => Some(joint),
            Self::Sight(_) | Self::Range(_) => None,
        }
    }

    /// Where the instrument stands whose readings scatter.
    #[must_use]
    pub fn instrument(self) -> Option<Place> {
        match self {
            Self::Joint(_) => None,
            Self::Sight(place) | Self::Range(place) => Some(place),
        }
    }
}
