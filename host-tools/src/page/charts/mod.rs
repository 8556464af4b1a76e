//! The kinds of charts, a file each: from records to panels.

mod covered;
mod curve;
mod errors;
mod intervals;
mod l_curve;
mod projections;
mod staircase;

pub use covered::covered;
pub use curve::{described, free_curve, part};
pub use errors::{before_and_after, method_errors, method_sizes, shares};
pub use intervals::corrections;
pub use l_curve::l_curve;
pub use projections::{magnified, projections};
pub use staircase::{Floor, Step, staircase};
