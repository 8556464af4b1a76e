//! From the descriptions people have of an arm to a robot.toml, and from an
//! identified arm to what other programs read.
//!
//! Stands on [`crate::files`] and [`crate::model`]. A description becomes joint
//! axes and a tip in space, at joint values zero ([`axes::Axes`]); from these
//! come the parameters, in whichever convention.

pub mod axes;
mod frames;
mod identified;
mod left_out;
pub mod presets;
mod reach;
pub mod table;
mod ur;
pub mod urdf;
mod verified;

pub use identified::Identified;
pub use left_out::{LeftOut, left_out};
pub use ur::ur_calibration;
pub use verified::verified;

/// A robot.toml with remarks on every key, for an arm of which there is neither
/// a URDF nor a table.
pub const TEMPLATE: &str = include_str!("template.toml");
