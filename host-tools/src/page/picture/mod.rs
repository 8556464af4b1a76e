//! What the figures of a page show beyond the report: rows in the robot's frame,
//! and the error of each as one joint, the base or a length would make it.

mod covariate;
mod parts;
mod seen;
mod unexplained;

pub use parts::{Part, parts};
pub use seen::{Arrow, Measured, Seen};
pub use unexplained::{Unexplained, unexplained};
