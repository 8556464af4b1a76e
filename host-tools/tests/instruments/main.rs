//! Every kind of measurement, alone and beside others.

mod beside;
mod each;
mod examples;
#[path = "../judged/mod.rs"]
mod judged;
mod places;
