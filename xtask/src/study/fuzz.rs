//! libFuzzer on the targets of `fuzz/`, guided by coverage, with the stable
//! compiler and checks of overflow switched on.

use clap::Args;

use crate::run::{Result, call, cargo, root, step, target_dir};
use crate::tools;

/// What cargo-fuzz would switch on, but for the tracing of compares: it costs
/// two thirds of the speed and finds nothing more; the magic is in the corpus.
/// A compiler may rename it.
const COVERAGE: &str = "--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
                        -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
                        -Cllvm-args=-sanitizer-coverage-pc-table";
/// With the most bytes of an input.
const TARGETS: [(&str, u32); 2] = [("decode", 2048), ("store", 64)];

#[derive(Args)]
pub struct Options {
    /// Executions of each target
    #[arg(long, default_value_t = 10_000_000)]
    runs: u64,
    /// Of the mutations
    #[arg(long, default_value_t = 1)]
    seed: u32,
}

pub fn study(options: &Options) -> Result {
    run(&[format!("-runs={}", options.runs), format!("-seed={}", options.seed)])
}

/// Runs every target with these arguments of libFuzzer.
pub fn run(arguments: &[String]) -> Result {
    let host = host()?;
    let built = target_dir().join("fuzz");
    step("build of the fuzz targets", || {
        // libFuzzer is C++ that its crate compiles.
        tools::ensure_program(
            "c++",
            "g++",
            "  Debian, Ubuntu  sudo apt-get install g++\n  \
               Fedora          sudo dnf install gcc-c++\n  \
               macOS           xcode-select --install",
        )?;
        let mut build = cargo(&root().join("fuzz"), "build --release --locked --target");
        build.arg(&host).arg("--target-dir").arg(&built);
        // With a target named, build scripts go without.
        call(build.env("RUSTFLAGS", COVERAGE))
    })?;
    for (target, longest) in TARGETS {
        let corpus = built.join("corpus").join(target);
        std::fs::create_dir_all(&corpus)?;
        if target == "decode" {
            for blob in ["firmware/ur10.blob", "firmware/ur10-terms.blob"] {
                let from = root().join("tests/data").join(blob);
                std::fs::copy(&from, corpus.join(blob.replace('/', "-")))?;
            }
        }
        step(&format!("fuzzing {target}"), || {
            let program = built.join(&host).join("release").join(target);
            let mut fuzz = std::process::Command::new(program);
            fuzz.arg(format!("-max_len={longest}")).arg("-print_final_stats=1").args(arguments);
            call(fuzz.arg(&corpus).current_dir(&built))
        })?;
    }
    Ok(())
}

/// What rustc builds for by itself.
fn host() -> Result<String> {
    let output = std::process::Command::new("rustc").arg("-vV").output()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.ok_or("rustc names no host")?.to_owned())
}
