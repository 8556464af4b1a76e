//! The crate as it would be published: it builds from its own files, and each
//! of its examples runs.

use std::fs;
use std::path::Path;

use crate::run::{Result, call, cargo, root, step, target_dir};

pub fn run() -> Result {
    step("package", || {
        let mut package = cargo(&root(), "package --package truearm --allow-dirty");
        call(package.arg("--target-dir").arg(target_dir()))
    })?;
    // All packages of the workspace have one version.
    let unpacked = target_dir().join(concat!("package/truearm-", env!("CARGO_PKG_VERSION")));
    step("examples of the package", || run_examples(&unpacked))
}

/// Each says by its exit status whether what it shows came out.
fn run_examples(package: &Path) -> Result {
    for entry in fs::read_dir(package.join("examples"))? {
        let path = entry?.path();
        if path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        let name = path.file_stem().unwrap_or_default();
        let mut run = cargo(package, "run --locked --example");
        call(run.arg(name).arg("--target-dir").arg(target_dir()))?;
    }
    Ok(())
}
