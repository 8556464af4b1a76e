//! What several errors say alike.

pub(crate) const BAD_SIGMA: &str = "sigma must be a positive number";
pub(crate) const LAST_SEQUENCE: &str = "no sequence number is left after the stored one";

/// Fewer equations than unknowns.
pub(crate) fn too_few(
    f: &mut core::fmt::Formatter<'_>,
    equations: u32,
    needed: u32,
) -> core::fmt::Result {
    write!(
        f,
        "{equations} equations where {needed} or more are needed: a point gives three, a touch \
         or a distance one"
    )
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
