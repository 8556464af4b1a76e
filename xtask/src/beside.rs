//! A verb that runs beside other work: what is built and run for a controller takes one core,
//! and has folders of its own. What it prints comes when it has ended, in one piece.

use std::fs::{self, File};
use std::process::{Child, Command};

use crate::run::{Result, target_dir};

/// A run of this program with another verb.
pub struct Beside {
    line: String,
    child: Child,
}

impl Beside {
    /// Starts it.
    pub fn start(line: &str) -> Result<Self> {
        let log = File::create(log_of(line)?)?;
        let mut command = Command::new(std::env::current_exe()?);
        command.args(line.split_whitespace()).stdout(log.try_clone()?).stderr(log);
        eprintln!("\n== {line}, beside what follows");
        Ok(Self { line: line.to_owned(), child: command.spawn()? })
    }

    /// Waits until it has ended, and prints what it did.
    pub fn end(mut self) -> Result {
        let status = self.child.wait()?;
        eprint!("{}", String::from_utf8_lossy(&fs::read(log_of(&self.line)?)?));
        match status.success() {
            true => Ok(()),
            false => Err(format!("{}, see above: {status}", self.line).into()),
        }
    }
}

fn log_of(line: &str) -> Result<std::path::PathBuf> {
    let folder = target_dir().join("beside");
    fs::create_dir_all(&folder)?;
    Ok(folder.join(line.replace(' ', "-")).with_extension("log"))
}
