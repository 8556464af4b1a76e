//! The book of `docs`, built by mdBook into `target/book`.

use std::path::PathBuf;
use std::process::Command;

use crate::run::{Result, call, cargo, exists, root, step, target_dir};

const PROGRAM: &str = "mdbook";
/// What the pages were tried with; later ones of 0.5 should do.
const VERSION: &str = "0.5.4";

pub fn run() -> Result {
    let program = step("mdBook", program)?;
    step("book", || call(Command::new(program).arg("build").arg(root().join("docs"))))?;
    println!("{}", root().join("target/book/index.html").display());
    Ok(())
}

/// The user's own, or one that is installed beside what is built; that takes minutes.
fn program() -> Result<PathBuf> {
    if exists(PROGRAM) {
        return Ok(PROGRAM.into());
    }
    let tools = target_dir().join("tools");
    let own = tools.join("bin").join(PROGRAM);
    if !own.is_file() {
        let mut install =
            cargo(&root(), "install --locked --no-default-features --features search");
        call(install.args([PROGRAM, "--version", VERSION]).arg("--root").arg(&tools))?;
    }
    Ok(own)
}
