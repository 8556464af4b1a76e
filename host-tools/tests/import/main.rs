//! Tables of any shape.

#[path = "../published/mod.rs"]
mod published;
mod tables;
