use std::path::PathBuf;

use clap::Args;
use truearm_host::Result;
use truearm_host::blob::difference;
use truearm_host::report::{DiffReport, to_json};

use super::{Said, count, read_blob};

/// Compare two parameter blobs: which parameters moved, and the tool with them.
#[derive(Args)]
pub struct Diff {
    /// The blob before
    before: PathBuf,
    /// The blob after
    after: PathBuf,
    /// Poses drawn from the workspace to find how far the tool moves
    #[arg(long, default_value_t = 10_000, value_parser = count, allow_hyphen_values = true)]
    poses: usize,
    /// Seed of the draw
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

impl Diff {
    pub fn run(self) -> Result<Said> {
        let [a, b] = [&self.before, &self.after].map(|path| read_blob(path));
        let (a, b) = (a?, b?);
        let found = difference(&a, &b, self.poses, self.seed)?;
        if !self.json {
            return Ok(found.words.into());
        }
        let files = [&self.before, &self.after].map(|path| path.display().to_string());
        Ok(to_json(&DiffReport::new(files, self.seed, found)).into())
    }
}
