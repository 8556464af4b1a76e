use crate::parameters::Parameter;
use crate::solve::SolveError;
use crate::words::{BAD_SIGMA, LAST_SEQUENCE, TooFew, holds_solve_error};

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
    /// The arm does not have this parameter, an earlier one is the same, or it is
    /// one of fewer than six of the tracker.
    BadParameter {
        /// Its 0-based index in the list.
        index: usize,
        /// The parameter.
        parameter: Parameter,
    },
    /// The standard deviation is not a positive number.
    BadSigma,
    /// The points lie on a line, which leaves the tracker's place open.
    PointsOnALine,
    /// The points do not determine this parameter, which has no prior.
    Undetermined {
        /// Its 0-based index in the list.
        index: usize,
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
            Self::TooFewPoints { points, needed } => TooFew { points, needed }.fmt(f),
            Self::PointNotFinite { point } => write!(f, "point {} is not finite", point + 1),
            Self::BadParameter { index, parameter } => {
                let place = index + 1;
                write!(
                    f,
                    "parameter {place}, {parameter}: not of this arm, or there twice, or without \
                     the five others of the tracker"
                )
            }
            Self::BadSigma => f.write_str(BAD_SIGMA),
            Self::PointsOnALine => f.write_str("the points lie on a line"),
            Self::Undetermined { index } => {
                let place = index + 1;
                write!(f, "the points do not determine parameter {place}, which has no prior")
            }
            Self::LastSequence => f.write_str(LAST_SEQUENCE),
            Self::NotConverged => f.write_str("the steps do not become small"),
            Self::Solve(error) => write!(f, "{error}"),
        }
    }
}

holds_solve_error!(ReidentifyError);
