//! For robots whose controller cannot be changed: where the tool is at given
//! joints, the joints for a pose of the tool, the joints that bring the real tool
//! to the commanded pose, and programs of them in a robot's own language.
//!
//! Pure functions of a [`Model`](crate::model::Model) and a
//! [`Path`](crate::model::Path). The frame is that of the files: the pose of
//! `[tool]` in the coordinates that `[base]` is stated in, so that what the nominal
//! arm says is what the controller says; a [`View`] chooses another.

mod choose;
mod compensate;
mod forward;
mod inverse;
mod law;
mod missing_inputs;
mod rows;
pub mod write;

pub use compensate::{CompensateOptions, Compensated, Row, Step, compensate, largest_steps};
pub use forward::{Forward, View};
pub use inverse::{Followed, Found, Inverse, REACHED_ANGLE, REACHED_POINT};
pub use missing_inputs::missing_inputs;
pub use rows::{compensated_csv, forward_csv, inverse_csv};
