//! What scatters beside the noise that rows state.

/// What may scatter by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scatterer {
    /// A joint, counted from 0: its angle, rad, or its way, m.
    Joint(usize),
    /// The line of sight from the origin of a station's coordinates: its angles, rad, so that a
    /// point is read the worse the farther away it is, across that line.
    Sight,
}

impl Scatterer {
    /// The joint, counted from 0.
    #[must_use]
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Joint(joint) => Some(joint),
            Self::Sight => None,
        }
    }
}
