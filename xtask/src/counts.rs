//! `cargo xtask counts`: instructions that valgrind counts of the host's kernels, held
//! against `batch/benches/counts.toml`. They are the same in every run, on a busy machine
//! as well, where times are not.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde_json::Value;

use crate::budgets::Budgets;
use crate::image::read_toml;
use crate::poses::POSES;
use crate::run::{Result, cargo, root, shown, step, target_dir};
use crate::tools;

const BENCH: &str = "bench --quiet --locked -p truearm-batch --features counts --bench counts";
const BUDGETS: Budgets =
    Budgets { file: "batch/benches/counts.toml", tables: &[("instructions", "a pose")] };
const RUNNER: &str = "gungraun-runner";

pub fn run() -> Result {
    if !counted_here() {
        eprintln!("\nnothing counted: the budgets are of Linux on x86-64 with AVX2");
        return Ok(());
    }
    let runner = step("valgrind and gungraun", programs)?;
    let output = step("instructions of the host's kernels", || counts(&runner))?;
    step("budgets", || BUDGETS.check(&output))
}

fn counted_here() -> bool {
    #[cfg(target_arch = "x86_64")]
    let avx2 = std::arch::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    let avx2 = false;
    cfg!(target_os = "linux") && avx2
}

/// What starts valgrind.
fn programs() -> Result<PathBuf> {
    let how = "  Debian, Ubuntu  sudo apt-get install valgrind\n  \
               Fedora          sudo dnf install valgrind";
    tools::ensure_program("valgrind", "valgrind", how)?;
    // The library and its runner are of one version. Optimised it would take twice as long to
    // build, and it only starts valgrind.
    tools::installed(RUNNER, &locked(RUNNER)?, "--debug --config profile.dev.debug=false")
}

/// The version of a package in the lock file.
fn locked(package: &str) -> Result<String> {
    let lock = read_toml(&root().join("Cargo.lock"))?;
    let packages = lock.get("package").and_then(toml::Value::as_array).into_iter().flatten();
    let mut packages = packages.filter(|entry| entry["name"].as_str() == Some(package));
    let version = packages.find_map(|entry| entry["version"].as_str().map(str::to_owned));
    version.ok_or_else(|| format!("no {package} in Cargo.lock").into())
}

/// Lines `instructions KERNEL COUNT`, of a pose.
fn counts(runner: &Path) -> Result<String> {
    let mut bench = cargo(&root(), &format!("{BENCH} -- --output-format=json"));
    bench.env("GUNGRAUN_RUNNER", runner).env("GUNGRAUN_HOME", target_dir().join("gungraun"));
    // Flags for this processor would be other instructions.
    bench.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    let output = bench.stderr(Stdio::inherit()).output()?;
    if !output.status.success() {
        return Err(format!("`{}`: {}", shown(&bench), output.status).into());
    }
    lines(&String::from_utf8(output.stdout)?)
}

/// Of gungraun's summaries, one a line.
fn lines(summaries: &str) -> Result<String> {
    let mut lines = String::new();
    for line in summaries.lines() {
        let summary: Value = serde_json::from_str(line)?;
        let kernel = (summary["function_name"].as_str(), summary["id"].as_str());
        let counted = summary.pointer("/profiles/0/data/total/metrics/Ir/values/new");
        let ((Some(kernel), Some(of)), Some(counted)) = (kernel, counted.and_then(Value::as_u64))
        else {
            return Err(format!("no count in {line}").into());
        };
        writeln!(lines, "instructions {kernel}-{of} {:.1}", counted as f64 / POSES as f64)?;
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::lines;

    #[test]
    fn counts_are_of_a_pose() {
        let summary = |metrics: &str| {
            format!(
                r#"{{"function_name":"batch","id":"avx2_f32","profiles":[{{"data":{{"total":
                {{"metrics":{metrics}}}}}}}]}}"#
            )
            .replace('\n', "")
        };
        let counted = lines(&summary(r#"{"Ir":{"values":{"new":118272,"old":1}}}"#));
        assert_eq!(counted.expect("a count"), "instructions batch-avx2_f32 115.5\n");
        assert!(lines(&summary("{}")).is_err());
    }
}
