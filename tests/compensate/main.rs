//! The compensator against the arm it compensates: what the law promises, what
//! is applied of it, what happens to bad input.

mod applied;
mod arms;
#[path = "../common/blobs.rs"]
mod blobs;
#[path = "../common/mod.rs"]
mod common;
mod law;
mod limits;
mod paths;
mod range;
mod readings;
mod shortcuts;
mod torques;
mod valid;
