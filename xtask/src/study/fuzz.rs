//! libFuzzer on the targets of `fuzz/`, guided by coverage, with the stable
//! compiler and checks of overflow switched on.

use std::path::Path;

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
/// Readers of the host's files.
const READERS: [(&str, u32); 1] = [("readers", 2048)];
/// Lines of a table that a reader begins with: more make it slow, and what is longer than an
/// input would be cut anywhere.
const LINES: usize = 6;
/// What each reader begins with: the bytes that choose it, and a file.
const FILES: [(&[u8], &str); 12] = [
    (&[0], "tests/data/seed-table-8/robot.toml"),
    (&[0], "host-tools/examples/instruments/robot.toml"),
    (&[1], "tests/data/seed-table-8/measurements.csv"),
    (&[1], "host-tools/examples/instruments/touches.csv"),
    (&[2], "host-tools/examples/instruments/instruments.toml"),
    (&[3], "tests/data/seed-table-8/measurements.csv"),
    (&[4], "tests/data/seed-table-8/measurements.csv"),
    (&[5], "tests/data/seed-table-8/robot.toml"),
    (&[6, 0], "host-tools/tests/data/urdf/puma560.urdf"),
    (&[6, 0], "host-tools/tests/data/urdf/irb910sc.urdf"),
    (&[7, 0], "tests/data/seed-table-8/measurements.csv"),
    (&[7, 1], "host-tools/examples/instruments/distances.csv"),
];

#[derive(Args)]
pub struct Options {
    /// Executions of each target
    #[arg(long, default_value_t = 10_000_000)]
    runs: u64,
    /// Of the mutations
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Of the host's files in place of the controller's memory
    #[arg(long)]
    readers: bool,
}

pub fn study(options: &Options) -> Result {
    let arguments = [format!("-runs={}", options.runs), format!("-seed={}", options.seed)];
    if options.readers {
        fuzz(&READERS, " --features readers", &arguments)
    } else {
        run(&arguments)
    }
}

/// Runs every target of the controller with these arguments of libFuzzer.
pub fn run(arguments: &[String]) -> Result {
    fuzz(&TARGETS, "", arguments)
}

fn fuzz(targets: &[(&str, u32)], features: &str, arguments: &[String]) -> Result {
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
        let build = format!("build --release --locked{features} --target");
        let mut build = cargo(&root().join("fuzz"), &build);
        build.arg(&host).arg("--target-dir").arg(&built);
        // With a target named, build scripts go without.
        call(build.env("RUSTFLAGS", COVERAGE))
    })?;
    for (target, longest) in targets {
        let corpus = built.join("corpus").join(target);
        begin(target, &corpus)?;
        step(&format!("fuzzing {target}"), || {
            let program = built.join(&host).join("release").join(target);
            let mut fuzz = std::process::Command::new(program);
            fuzz.arg(format!("-max_len={longest}")).arg("-print_final_stats=1").args(arguments);
            call(fuzz.arg(&corpus).current_dir(&built))
        })?;
    }
    Ok(())
}

/// Inputs that mutations begin with.
fn begin(target: &str, corpus: &Path) -> Result {
    std::fs::create_dir_all(corpus)?;
    let blobs = [
        "tests/data/firmware/ur10.blob",
        "tests/data/firmware/ur10-terms.blob",
        "tests/data/golden/layout-3-gaps.blob",
        "tests/data/golden/layout-3-full.blob",
        "tests/data/golden/layout-3-lateral.blob",
        "tests/data/golden/layout-3-torques.blob",
    ];
    let inputs: Vec<(&[u8], &str)> = match target {
        "decode" => blobs.map(|blob| (&[][..], blob)).to_vec(),
        "readers" => FILES.to_vec(),
        _ => Vec::new(),
    };
    for (number, (first, file)) in inputs.into_iter().enumerate() {
        let mut bytes = std::fs::read(root().join(file))?;
        if file.ends_with(".csv") {
            bytes = bytes
                .split_inclusive(|byte| *byte == b'\n')
                .take(LINES)
                .flatten()
                .copied()
                .collect();
        }
        std::fs::write(corpus.join(format!("begin-{number}")), [first, &bytes].concat())?;
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
