//! What compensation promises, along a million ticks of random paths.

use crate::run::{Result, call, cargo, root};

pub fn run() -> Result {
    let mut test = cargo(&root(), "test --quiet --release --package truearm --test compensate --");
    call(test.args(["--ignored", "--nocapture", "along_a_million_ticks"]))
}
