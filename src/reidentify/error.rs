use crate::solve::SolveError;

/// Why a re-identification gave no parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ReidentifyError {
    /// Fewer equations than unknowns.
    TooFewPoints {
        /// Points given.
        points: usize,
        /// Points needed.
        needed: usize,
    },
    /// This point has a number that is none.
    PointNotFinite {
        /// Its 0-based index.
        point: usize,
    },
    /// This unknown names no parameter of the arm, repeats an earlier one, or is
    /// one of fewer than six of the tracker.
    BadUnknown {
        /// Its 0-based index.
        unknown: usize,
    },
    /// The standard deviation is not a positive number.
    BadSigma,
    /// The points lie on a line, which leaves the tracker's place open.
    PointsOnALine,
    /// The points do not determine this unknown, which has no prior.
    Undetermined {
        /// Its 0-based index.
        unknown: usize,
    },
    /// The stored set has the last sequence number that can be followed by one.
    LastSequence,
    /// The steps do not become small: joints or points are not what they seem.
    NotConverged,
    /// A solve failed.
    Solve(SolveError),
}

impl core::fmt::Display for ReidentifyError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFewPoints { points, needed } => {
                write!(f, "{points} points where {needed} or more are needed")
            }
            Self::PointNotFinite { point } => write!(f, "point {point} is not finite"),
            Self::BadUnknown { unknown } => {
                write!(
                    f,
                    "unknown {unknown} does not exist, or twice, or its five companions do not"
                )
            }
            Self::BadSigma => f.write_str("sigma must be a positive number"),
            Self::PointsOnALine => f.write_str("the points lie on a line"),
            Self::Undetermined { unknown } => {
                write!(f, "the points do not determine unknown {unknown}, which has no prior")
            }
            Self::LastSequence => f.write_str("no sequence number is left after the stored one"),
            Self::NotConverged => f.write_str("the steps do not become small"),
            Self::Solve(error) => write!(f, "{error}"),
        }
    }
}

impl core::error::Error for ReidentifyError {}

impl From<SolveError> for ReidentifyError {
    fn from(error: SolveError) -> Self {
        Self::Solve(error)
    }
}
