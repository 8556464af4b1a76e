//! Where a fit begins: frames of base and tracker, what rows refer to, the tool.

mod instruments;
pub mod registration;
mod rigid;
pub mod tool;

pub use rigid::{Pairs, rigid_transform};
