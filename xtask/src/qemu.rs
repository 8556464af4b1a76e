//! The tools the firmware needs, and a QEMU run that cannot hang.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::proof;
use crate::run::{Result, call, exists, shown, step};

/// What rustc calls the controller.
pub const TARGET: &str = "thumbv7em-none-eabihf";
const QEMU: &str = "qemu-system-arm";
const LIMIT: Duration = Duration::from_secs(60);

/// Installs the targets and QEMU where that is possible without asking.
pub fn ensure_tools() -> Result {
    step("tools", || {
        let installed = installed_targets()?;
        for target in proof::TARGETS {
            if !installed.lines().any(|line| line == target) {
                call(Command::new("rustup").args(["target", "add", target]))?;
            }
        }
        ensure(
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
        let targets = proof::TARGETS.join(" ");
        format!("rustup: {error}; without rustup, install by hand the Rust targets {targets}")
    })?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Installs a program that is missing by Debian's packages, as root where there
/// is Debian; otherwise the error says how to.
pub fn ensure(program: &str, packages: &str, how: &str) -> Result {
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

/// How an image ended.
pub struct Ended {
    /// Whether it exited with 0.
    pub success: bool,
    /// What it printed.
    pub output: String,
}

/// Runs a QEMU command in `dir` and echoes its output; more than a minute is
/// an error.
pub fn run(command: &[String], dir: &Path) -> Result<Ended> {
    let mut child = start(command, dir, Stdio::piped())?;
    let output = child.stdout.take().ok_or("QEMU without an output")?;
    let echo = thread::spawn(move || {
        let mut text = String::new();
        for line in BufReader::new(output).lines().map_while(std::io::Result::ok) {
            println!("{line}");
            text.push_str(&line);
            text.push('\n');
        }
        text
    });
    let success = wait(child)?;
    let output = echo.join().map_err(|_| "reading QEMU's output failed")?;
    Ok(Ended { success, output })
}

/// The same for an output that is no text: it goes to a file. Whether the image
/// exited with 0.
pub fn run_to(file: &Path, command: &[String], dir: &Path) -> Result<bool> {
    wait(start(command, dir, File::create(file)?.into())?)
}

fn start(command: &[String], dir: &Path, output: Stdio) -> Result<Child> {
    let (program, arguments) = command.split_first().ok_or("an empty QEMU command")?;
    let mut command = Command::new(program);
    command.args(arguments).current_dir(dir).stdin(Stdio::null()).stdout(output);
    eprintln!("{}", shown(&command));
    command.spawn().map_err(|error| format!("{program}: {error}").into())
}

fn wait(mut child: Child) -> Result<bool> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status.success());
        }
        if start.elapsed() > LIMIT {
            child.kill()?;
            child.wait()?;
            return Err(format!("the image did not end within {} s", LIMIT.as_secs()).into());
        }
        thread::sleep(Duration::from_millis(20));
    }
}
