//! Studies: what truearm finds on arms whose truth is known. Each has a small
//! seeded part that the tests run, and a long form, `cargo xtask study NAME`.

#![allow(missing_docs, reason = "for this repository only")]

mod apart;
pub mod blind;
pub mod check;
pub mod coverage;
pub mod dirty;
pub mod fleet;
pub mod instruments;
#[path = "../../host-tools/tests/judged/mod.rs"]
pub mod judged;
#[path = "../../host-tools/tests/mistakes/mod.rs"]
pub mod mistakes;
pub mod planning;
pub mod regret;
pub mod reproduce;
#[path = "../../host-tools/tests/simulated/mod.rs"]
pub mod simulated;
pub mod studies;
mod terms;
pub mod warming;
