use std::path::PathBuf;

use clap::Args;
use truearm_host::describe::describe;
use truearm_host::{Error, Result};

/// Print every field of a parameter blob, or why a controller would refuse it.
#[derive(Args)]
pub struct Inspect {
    /// The blob
    blob: PathBuf,
}

impl Inspect {
    pub fn run(self) -> Result<()> {
        let bytes = std::fs::read(&self.blob).map_err(|e| Error::io(&self.blob, e))?;
        let text = describe(&bytes).map_err(|e| {
            Error::data(
                format!("{}: {e}", self.blob.display()),
                "a controller refuses it too; pack the model again",
            )
        })?;
        print!("{text}");
        Ok(())
    }
}
