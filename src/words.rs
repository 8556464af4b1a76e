//! What several errors say alike.

pub(crate) const BAD_SIGMA: &str = "sigma must be a positive number";
pub(crate) const LAST_SEQUENCE: &str = "no sequence number is left after the stored one";

/// Fewer equations than unknowns.
pub(crate) struct TooFew<I> {
    pub points: I,
    pub needed: I,
}

impl<I: core::fmt::Display> core::fmt::Display for TooFew<I> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { points, needed } = self;
        write!(f, "{points} points where {needed} or more are needed")
    }
}

/// An error whose `Solve` holds that of a solve: its source, and how one becomes
/// the other.
macro_rules! holds_solve_error {
    ($error:ident) => {
        impl core::error::Error for $error {
            fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
                match self {
                    Self::Solve(error) => Some(error),
                    _ => None,
                }
            }
        }

        impl From<crate::solve::SolveError> for $error {
            fn from(error: crate::solve::SolveError) -> Self {
                Self::Solve(error)
            }
        }
    };
}
pub(crate) use holds_solve_error;
