//! Where a fit begins: frames of base and tracker, what rows refer to, the tool.

mod alone;
pub mod cameras;
mod instruments;
pub mod registration;
mod rigid;
pub mod tool;
mod turned;
pub mod zeros;

pub use rigid::{Pairs, frame_between, on_a_line, rigid_transform};
pub use turned::first;
