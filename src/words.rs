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

/// Readings that contradict a fit.
pub(crate) fn inconsistent(f: &mut core::fmt::Formatter<'_>, times: u32) -> core::fmt::Result {
    write!(f, "the readings scatter by up to {times} times the stated sigma about what was found")
}

/// An error whose variants hold those of others: its source, and how one becomes the other.
macro_rules! holds_errors {
    ($error:ident: $($variant:ident($held:ty)),*) => {
        impl core::error::Error for $error {
            fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
                match self {
                    $(Self::$variant(error) => Some(error),)*
                    _ => None,
                }
            }
        }

        $(impl From<$held> for $error {
            fn from(error: $held) -> Self {
                Self::$variant(error)
            }
        })*
    };
}
pub(crate) use holds_errors;
