//! What is missing, and its name.

mod arrival;
mod by_kind;
mod curves;
mod few_digits;
mod first_sides;
mod hidden_effects;
mod hold_out;
#[path = "../judged/mod.rs"]
mod judged;
mod late;
mod lines;
mod noise;
mod one_point;
mod other_arms;
mod other_cells;
mod repeats;
mod scatter;
mod session;
#[path = "../simulated/mod.rs"]
mod simulated;
mod springs;
mod steps;
mod ur10;
mod wrong_sigma;
