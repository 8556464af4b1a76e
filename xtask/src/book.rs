//! The book of `docs`, built by mdBook into `target/book`.

use std::path::PathBuf;
use std::process::Command;

use crate::run::{Result, call, exists, root, step};
use crate::tools;

const PROGRAM: &str = "mdbook";
/// What the pages were tried with; later ones of 0.5 should do.
const VERSION: &str = "0.5.4";

pub fn run() -> Result {
    let program = step("mdBook", program)?;
    step("book", || call(Command::new(program).arg("build").arg(root().join("docs"))))?;
    println!("{}", root().join("target/book/index.html").display());
    Ok(())
}

/// The user's own, or one that is installed.
fn program() -> Result<PathBuf> {
    match exists(PROGRAM) {
        true => Ok(PROGRAM.into()),
        false => tools::installed(PROGRAM, VERSION, "--no-default-features --features search"),
    }
}
