//! Before the measurement and after the flash.

mod by_kind;
mod cli;
#[path = "../judged/mod.rs"]
mod judged;
mod planned_kinds;
mod planning;
#[path = "../simulated/mod.rs"]
mod simulated;
mod verify;
