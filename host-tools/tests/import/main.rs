//! Tables of any shape.

mod keys;
#[path = "../published/mod.rs"]
mod published;
mod rows;
mod seconds;
mod tables;
mod times;
