//! Gross mistakes in files and set-up.

mod few_lengths;
mod found;
#[path = "../mistakes/mod.rs"]
mod mistakes;
#[path = "../simulated/mod.rs"]
mod simulated;
