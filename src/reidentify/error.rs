use crate::blob::EncodeError;
use crate::measurement::MeasurementError;
use crate::parameters::Parameter;
use crate::solve::SolveError;
use crate::words::{BAD_SIGMA, LAST_SEQUENCE, holds_errors, inconsistent, too_few};

/// Why a re-identification gave no parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ReidentifyError {
    /// Fewer equations than unknowns.
    TooFewEquations {
        /// Equations of the measurements given.
        equations: u32,
        /// Equations needed.
        needed: u32,
    },
    /// This measurement cannot be taken.
    BadMeasurement {
        /// Its 0-based index.
        index: usize,
        /// Why.
        why: MeasurementError,
    },
    /// The arm does not have this parameter, an earlier one is the same, or it is
    /// one of fewer than six of the tracker.
    BadParameter {
        /// Its 0-based index in the list.
        index: usize,
        /// The parameter.
        parameter: Parameter,
    },
    /// The scale of this parameter is not positive, or it is finite and the parameter one
    /// of the tracker, whose place has no prior.
    BadScale {
        /// Its 0-based index in the list.
        index: usize,
        /// The parameter.
        parameter: Parameter,
    },
    /// The standard deviation is not a positive number.
    BadSigma,
    /// The points lie on a line, or are fewer than three, which leaves the tracker's place open.
    PointsOnALine,
    /// The measurements do not determine this parameter, which has no prior.
    Undetermined {
        /// Its 0-based index in the list.
        index: usize,
    },
    /// The stored set has the last sequence number that can be followed by one.
    LastSequence,
    /// The steps do not become small: joints or measurements are not what they seem.
    NotConverged,
    /// The readings contradict what was found, see [`Misfit`](crate::solve::Misfit): one of them
    /// is wrong, something moved that is none of the parameters, or sigma is less than half of
    /// what it is.
    Inconsistent {
        /// How many times sigma they scatter about it, rounded up.
        times: u32,
        /// 0-based index of the measurement that is farthest from it: of one that is wrong, as a
        /// rule that one.
        worst: usize,
    },
    /// What was found is beyond what any arm is off by, or was so before.
    NotStorable(EncodeError),
    /// A solve failed.
    Solve(SolveError),
}

impl core::fmt::Display for ReidentifyError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFewEquations { equations, needed } => too_few(f, *equations, *needed),
            Self::BadMeasurement { index, why } => write!(f, "measurement {} is {why}", index + 1),
            Self::BadParameter { index, parameter } => {
                let place = index + 1;
                write!(
                    f,
                    "parameter {place}, {parameter}: not of this arm, or there twice, or without \
                     the five others of the tracker"
                )
            }
            Self::BadScale { index, parameter } => {
                let must = if parameter.is_station() { "infinite" } else { "positive" };
                write!(f, "the scale of parameter {}, {parameter}, must be {must}", index + 1)
            }
            Self::BadSigma => f.write_str(BAD_SIGMA),
            Self::PointsOnALine => {
                f.write_str("three points that are not on a line are needed to place the tracker")
            }
            Self::Undetermined { index } => {
                let place = index + 1;
                write!(f, "the measurements do not determine parameter {place}, which has no prior")
            }
            Self::LastSequence => f.write_str(LAST_SEQUENCE),
            Self::NotConverged => f.write_str("the steps do not become small"),
            Self::Inconsistent { times, worst } => {
                inconsistent(f, *times)?;
                write!(f, "; measurement {} is farthest off", worst + 1)
            }
            Self::NotStorable(error) => write!(f, "{error}"),
            Self::Solve(error) => write!(f, "{error}"),
        }
    }
}

holds_errors!(ReidentifyError: Solve(SolveError), NotStorable(EncodeError));
