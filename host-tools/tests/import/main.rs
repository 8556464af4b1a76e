//! Tables of any shape.

mod keys;
#[path = "../published/mod.rs"]
mod published;
mod rows;
mod tables;
mod times;
