//! Dirty sets: several effects at once, noise misstated, poses as people choose
//! them.

pub mod score;
pub mod set;
mod truth;
