//! Dirty sets: several effects at once, noise misstated, poses as people choose
//! them.

pub mod outside;
pub mod reliability;
pub mod score;
pub mod set;
pub mod springs;
pub mod tables;
mod told;
mod truth;
