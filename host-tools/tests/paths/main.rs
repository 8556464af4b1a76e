//! Paths compensated.

mod cli;
mod compensated;
mod reach;
mod torques;
