use crate::blob::EncodeError;
use crate::measurement::MeasurementError;
use crate::parameters::Parameter;
use crate::solve::SolveError;
use crate::words::{BAD_SIGMA, LAST_SEQUENCE, holds_errors, inconsistent, too_few};

/// Why a measurement was not taken or no parameters were given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StreamingError {
    /// The arm does not have this parameter, an earlier one is the same, or it is
    /// of the tracker, whose place must be known here.
    BadParameter {
        /// Its 0-based index in the list.
        index: usize,
        /// The parameter.
        parameter: Parameter,
    },
    /// The scale of this parameter is not positive, or it is infinite and one before it is
    /// not.
    BadScale {
        /// Its 0-based index in the list.
        index: usize,
        /// The parameter.
        parameter: Parameter,
    },
    /// The standard deviation is not a positive number.
    BadSigma,
    /// The measurement cannot be taken.
    BadMeasurement(MeasurementError),
    /// Fewer equations than parameters.
    TooFewEquations {
        /// Equations of the measurements taken.
        equations: u32,
        /// Equations needed.
        needed: u32,
    },
    /// The L-curve has no corner.
    NoCorner,
    /// No measurement was held out to judge lambda by, or none by which a lambda could be judged.
    NothingHeldOut,
    /// Neither the measurements nor lambda determine this parameter.
    Undetermined {
        /// Its 0-based index in the list.
        index: usize,
    },
    /// The stored set has the last sequence number that can be followed by one.
    LastSequence,
    /// The readings contradict what was found, see [`Misfit`](crate::solve::Misfit): one of them
    /// is wrong, something moved that is none of the parameters, more moved than one
    /// linearisation holds for, or sigma is less than half of what it is.
    Inconsistent {
        /// How many times sigma they scatter about it, rounded up.
        times: u32,
    },
    /// What was found is beyond what any arm is off by, or was so before.
    NotStorable(EncodeError),
    /// A row was refused or a solve failed.
    Solve(SolveError),
}

impl core::fmt::Display for StreamingError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::BadParameter { index, parameter } => {
                let place = index + 1;
                write!(f, "parameter {place}, {parameter}: not of this arm, or there twice")
            }
            Self::BadScale { index, parameter } => {
                let place = index + 1;
                write!(
                    f,
                    "the scale of parameter {place}, {parameter}: not positive, or infinite \
                     behind a finite one"
                )
            }
            Self::BadSigma => f.write_str(BAD_SIGMA),
            Self::BadMeasurement(why) => write!(f, "the measurement is {why}"),
            Self::TooFewEquations { equations, needed } => too_few(f, *equations, *needed),
            Self::NoCorner => f.write_str("the L-curve has no corner"),
            Self::NothingHeldOut => f.write_str("no measurement was held out to judge lambda by"),
            Self::Undetermined { index } => {
                let place = index + 1;
                write!(f, "the measurements do not determine parameter {place}, and lambda is zero")
            }
            Self::LastSequence => f.write_str(LAST_SEQUENCE),
            Self::Inconsistent { times } => inconsistent(f, *times),
            Self::NotStorable(error) => write!(f, "{error}"),
            Self::Solve(error) => write!(f, "{error}"),
        }
    }
}

holds_errors!(StreamingError: Solve(SolveError), NotStorable(EncodeError));
