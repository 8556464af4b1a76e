//! `cargo xtask firmware`: the controller image, from build to budget.

use std::path::Path;

use crate::image::{
    CURVES, build, build_in, command, dir_of, directory, files_for, image_in, qemu_command,
    run_image,
};
use crate::run::{Result, call, step};
use crate::vectors::{self, Files};
use crate::{budgets, image_refusals, m7, proof, qemu, reidentify, sigma, tools, touches};

pub fn run(blob: Option<&Path>) -> Result {
    tools::ensure()?;
    proof::usual()?;
    let files = match blob {
        Some(blob) => files_for(blob)?,
        None => vectors::shipped(),
    };
    run_all(&files)?;
    step("in f64 on a Cortex-M7", m7::check)?;
    step("slot B and refusals", || image_refusals::check(&command(&files)?))
}

/// Every image that prints what it costs, held against the budgets.
pub fn budgets() -> Result {
    tools::ensure()?;
    run_all(&vectors::shipped())
}

/// The image that knows of curves, on the blob that has some.
fn curves() -> Result<String> {
    let dir = dir_of("curves");
    call(build_in(&dir, "firmware").args(CURVES))?;
    let command = qemu_command(&image_in(&dir, "firmware"), &vectors::shipped_curves())?;
    let ended = qemu::run(&command, &directory())?;
    if ended.success { Ok(ended.output) } else { Err("the image found a fault".into()) }
}

fn run_all(files: &Files) -> Result {
    step("build of the image", || call(&mut build("firmware")))?;
    let mut output = step("run under QEMU", || run_image(files))?;
    output += &step("run with terms of every effect", || run_image(&vectors::shipped_terms()))?;
    output += &step("run with curves", curves)?;
    output += &step("uncertainty of the tool point", sigma::check)?;
    output += &step("re-identification", reidentify::check)?;
    output += &step("touches of a plate", touches::check)?;
    output += &step("a controller and nothing else", budgets::controller)?;
    step("budgets", || budgets::IMAGES.check(&output))
}
