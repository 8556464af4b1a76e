//! Gross mistakes in files and set-up.

mod found;
#[path = "../mistakes/mod.rs"]
mod mistakes;
#[path = "../simulated/mod.rs"]
mod simulated;
