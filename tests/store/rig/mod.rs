//! Memory whose power fails, and what a store must be like on it. Shared by the
//! tests, `cargo xtask study cuts` and the fuzz targets.

#![allow(dead_code, reason = "each of its three users needs a part")]

pub mod cells;
pub mod cuts;
pub mod samples;
