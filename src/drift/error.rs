use crate::solve::SolveError;
use crate::words::{BAD_SIGMA, holds_errors};

/// Why a point was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum DriftError {
    /// Sigma is not a positive number.
    BadSigma,
    /// The point, its baseline or what the model makes of it is not finite.
    NotFinite,
    /// The point is too far from the model to be counted in standard deviations.
    Solve(SolveError),
}

impl core::fmt::Display for DriftError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::BadSigma => f.write_str(BAD_SIGMA),
            Self::NotFinite => f.write_str("a check point is not finite"),
            Self::Solve(error) => write!(f, "a check point cannot be taken: {error}"),
        }
    }
}

holds_errors!(DriftError: Solve(SolveError));
