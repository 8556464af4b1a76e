//! Paths compensated.

mod cli;
mod compensated;
mod gaps;
mod reach;
mod torques;
