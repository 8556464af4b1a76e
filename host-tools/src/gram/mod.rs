//! Identification by parts: the rows of an arm's measurements where they are, on many machines,
//! and one solve.
//!
//! A state is a model.toml that is on the way ([`GramState`](crate::model::GramState)): first
//! that of `identify` on some of the rows, which knows every station and marker. A round is
//! [`accumulate()`] of every part at that state, [`Part::plus`] of all of them in any order, and
//! [`step()`] to the next state, until that is settled. What is summed is all that a round needs
//! of the rows: normal equations about the state itself, by fold of poses; how the residuals are
//! distributed; what the points say of the robot's frame. The answer does not depend on how the
//! rows were split.
//!
//! The first round only measures the scale of the residuals. The next ones flag gross errors by
//! it and choose lambda, until the state is near its end ([`NEAR`]): from then on both stay as they
//! are, so that the end is one point.

mod accumulate;
mod file;
mod histogram;
mod part;
mod state;
mod step;
mod whole;

pub use accumulate::accumulate;
pub use file::{NoPart, is_part};
pub use part::Part;
pub use step::{Step, step};
pub use whole::{DRAWN, LARGE, identify_in_pieces, sums_tell};

/// Parts of the rows that are held out one after the other, by the pose.
pub const FOLDS: usize = 10;
/// A step, in tolerances, after which neither the scale of the residuals nor lambda is taken anew:
/// from a start far off they are what that start leaves, and not what the arm does.
pub const NEAR: f64 = 0.01;
/// Rounds after which they are not taken anew either, should flags come and go.
pub const LAST: u32 = 12;
