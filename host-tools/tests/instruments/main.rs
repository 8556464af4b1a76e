//! Every kind of measurement, alone and beside others.

mod beside;
mod each;
#[path = "../judged/mod.rs"]
mod judged;
