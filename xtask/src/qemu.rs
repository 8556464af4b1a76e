//! A QEMU run that cannot hang.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::run::{Result, shown};

/// Of what hangs; an image takes seconds, and a minute on a machine that is busy.
const LIMIT: Duration = Duration::from_secs(600);

/// How an image ended.
pub struct Ended {
    /// Whether it exited with 0.
    pub success: bool,
    /// What it printed.
    pub output: String,
}

/// Runs a QEMU command in `dir` and echoes its output; more than [`LIMIT`] is
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
