//! Tables of any shape.

mod keys;
#[path = "../published/mod.rs"]
mod published;
mod tables;
