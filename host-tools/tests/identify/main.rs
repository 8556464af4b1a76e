//! Identification without effects: what it finds, what the data leave open, what is refused.

mod contradiction;
mod covariance;
mod frames;
mod methods;
#[path = "../simulated/mod.rs"]
mod simulated;
mod solver;
mod streaming;
mod synthetic;
mod table_8;
mod undetermined;
