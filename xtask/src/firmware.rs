//! `cargo xtask firmware`: the controller image, from build to budget.

use std::path::Path;

use crate::image::{build, command, files_for, run_image};
use crate::run::{Result, call, step};
use crate::vectors::{self, Files};
use crate::{budgets, m7, proof, refusals, reidentify, sigma, tools};

pub fn run(blob: Option<&Path>) -> Result {
    tools::ensure()?;
    proof::usual()?;
    let files = match blob {
        Some(blob) => files_for(blob)?,
        None => vectors::shipped(),
    };
    run_all(&files)?;
    step("in f64 on a Cortex-M7", m7::check)?;
    step("slot B and refusals", || refusals::check(&command(&files)?))
}

/// Every image that prints what it costs, held against the budgets.
pub fn budgets() -> Result {
    tools::ensure()?;
    run_all(&vectors::shipped())
}

fn run_all(files: &Files) -> Result {
    step("build of the image", || call(&mut build("firmware")))?;
    let mut output = step("run under QEMU", || run_image(files))?;
    output += &step("run with terms of every effect", || run_image(&vectors::shipped_terms()))?;
    output += &step("uncertainty of the tool point", sigma::check)?;
    output += &step("re-identification", reidentify::check)?;
    output += &step("a controller and nothing else", budgets::controller)?;
    step("budgets", || budgets::check(&output))
}
