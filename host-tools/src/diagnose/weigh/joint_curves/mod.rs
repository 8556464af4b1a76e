//! Which joints err by curves, and what these are worth.

pub mod choice;
pub mod worth;
