/// Why a measurement cannot be taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum MeasurementError {
    /// It has a number that is none.
    NotFinite,
    /// The place of its plane or anchor is unknown, and none of the parameters is of it.
    PlaceNotChosen,
    /// The model sees the tool point within a micrometre of the anchor: from there every
    /// direction is as good as any other.
    AtAnchor,
}

impl core::fmt::Display for MeasurementError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "not finite",
            Self::PlaceNotChosen => "of an unknown place that is not among the parameters",
            Self::AtAnchor => "of a distance from where the tool point is",
        })
    }
}

impl core::error::Error for MeasurementError {}

/// Why there is no plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PlaneError {
    /// A coordinate is not a number, or too large for one to be squared.
    NotFinite,
    /// The normal has no direction: it is zero, or too small to be squared.
    NoNormal,
    /// The three points lie on a line.
    PointsOnALine,
}

impl core::fmt::Display for PlaneError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "point and normal of a plane must be finite",
            Self::NoNormal => "the normal of a plane must not be zero",
            Self::PointsOnALine => "the three points of the plane lie on a line",
        })
    }
}

impl core::error::Error for PlaneError {}
