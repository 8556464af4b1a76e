//! A verb that runs beside other work: what is built and run for a controller takes one core,
//! and nearly all of it has folders of its own; for the rest cargo waits. What it prints comes
//! when it has ended, in one piece.

use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Child, Command};

use crate::run::{Result, target_dir};

/// A run of this program with another verb.
pub struct Beside {
    line: String,
    child: Child,
    log: PathBuf,
}

impl Beside {
    /// Starts it.
    pub fn start(line: &str) -> Result<Self> {
        let folder = target_dir().join("beside");
        fs::create_dir_all(&folder)?;
        let name = format!("{}-{}.log", line.replace(' ', "-"), std::process::id());
        let log = folder.join(name);
        let file = File::create(&log)?;
        let mut command = Command::new(std::env::current_exe()?);
        command.args(line.split_whitespace()).stdout(file.try_clone()?).stderr(file);
        eprintln!("\n== {line}, beside what follows; until it has ended in {}", log.display());
        Ok(Self { line: line.to_owned(), child: command.spawn()?, log })
    }

    /// Waits until it has ended, and prints what it did.
    pub fn end(mut self) -> Result {
        let status = self.child.wait()?;
        eprint!("{}", String::from_utf8_lossy(&fs::read(&self.log)?));
        fs::remove_file(&self.log)?;
        match status.success() {
            true => Ok(()),
            false => Err(format!("{}, see above: {status}", self.line).into()),
        }
    }
}
