//! The compilers' targets and the programs that the firmware and others need.

use std::path::PathBuf;
use std::process::Command;

use crate::run::{Result, call, cargo, exists, root, step, target_dir};

/// What rustc calls the controller.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// A Cortex-M0, without division, and a Cortex-M33; both without floating point.
pub const OTHERS: [&str; 2] = ["thumbv6m-none-eabi", "thumbv8m.main-none-eabihf"];
/// Where the crate has to build, without an image.
pub const RISC_V: &str = "riscv32imc-unknown-none-elf";
/// What has to be installed.
const TARGETS: [&str; 4] = [TARGET, OTHERS[0], OTHERS[1], RISC_V];
const QEMU: &str = "qemu-system-arm";

/// Installs the targets and QEMU where that is possible without asking.
pub fn ensure() -> Result {
    step("tools", || {
        let installed = installed_targets()?;
        for target in TARGETS {
            if !installed.lines().any(|line| line == target) {
                call(Command::new("rustup").args(["target", "add", target]))?;
            }
        }
        ensure_program(
            QEMU,
            "qemu-system-arm",
            "  Debian, Ubuntu  sudo apt-get install qemu-system-arm\n  \
               Fedora          sudo dnf install qemu-system-arm-core\n  \
               macOS           brew install qemu",
        )
    })
}

fn installed_targets() -> Result<String> {
    let output = Command::new("rustup").args(["target", "list", "--installed"]).output();
    let output = output.map_err(|error| {
        let targets = TARGETS.join(" ");
        format!("rustup: {error}; without rustup, install by hand the Rust targets {targets}")
    })?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Installs a program that is missing by Debian's packages, as root where there
/// is Debian; otherwise the error says how to.
pub fn ensure_program(program: &str, packages: &str, how: &str) -> Result {
    if exists(program) {
        return Ok(());
    }
    let user = Command::new("id").arg("-u").output();
    let is_root = user.is_ok_and(|output| output.stdout.trim_ascii() == b"0");
    if !(is_root && exists("apt-get")) {
        return Err(format!("{program} is not installed. Install it:\n{how}").into());
    }
    let apt = |arguments: &[&str]| {
        call(Command::new("apt-get").env("DEBIAN_FRONTEND", "noninteractive").args(arguments))
    };
    apt(&["update"])?;
    let install = ["install", "-y", "--no-install-recommends"];
    apt(&install.into_iter().chain(packages.split_whitespace()).collect::<Vec<_>>())
}

/// A program of crates.io in one version, installed beside what is built; that takes
/// minutes, once. `options` are cargo's.
pub fn installed(program: &str, version: &str, options: &str) -> Result<PathBuf> {
    let folder = target_dir().join("tools").join(format!("{program}-{version}"));
    let path = folder.join("bin").join(program);
    if !path.is_file() {
        let mut install = cargo(&root(), &format!("install --locked {options}"));
        call(install.args([program, "--version", version]).arg("--root").arg(&folder))?;
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use crate::run::{cargo, root};

    /// Features of every crate, of these packages.
    fn features(selection: &str) -> BTreeMap<String, Vec<String>> {
        let line = format!("tree --locked --prefix none {selection} --format");
        let output = cargo(&root(), &line).arg("{p}|{f}").output().expect("cargo tree");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let mut features = BTreeMap::<String, Vec<String>>::new();
        for (package, line) in
            String::from_utf8_lossy(&output.stdout).lines().filter_map(|line| line.split_once('|'))
        {
            let line = line.trim_end_matches(" (*)").to_owned();
            features.entry(package.to_owned()).or_default().push(line);
        }
        for lines in features.values_mut() {
            lines.sort();
            lines.dedup();
        }
        features
    }

    #[test]
    fn tests_and_xtask_are_compiled_once() {
        let tests = features("--workspace --edges normal,build,dev");
        let missing: Vec<String> = features("--package xtask --edges normal,build")
            .into_iter()
            .filter(|(package, lines)| lines.iter().any(|line| !tests[package].contains(line)))
            .map(|(package, lines)| format!("{package}: {lines:?}, tests {:?}", tests[&package]))
            .collect();
        assert!(missing.is_empty(), "features for xtask/Cargo.toml:\n{}", missing.join("\n"));
    }
}
