use std::path::PathBuf;

use clap::Args;
use truearm::blob::Blob;
use truearm_host::Result;
use truearm_host::blob::{Name, contents, not_carried, unpack};
use truearm_host::files::write;
use truearm_host::report::{UnpackReport, to_json};

use super::{Said, overwrite, read_blob, refused};

/// Make a model.toml of a parameter blob; packing it gives the same bytes (`pack --covariance` where it has one).
#[derive(Args)]
pub struct Unpack {
    /// The blob
    blob: PathBuf,
    /// The model.toml to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Name of the robot, which the blob has only as a hash
    #[arg(long)]
    name: Option<String>,
    /// Its serial number
    #[arg(long, requires = "name", default_value = "")]
    serial: String,
    /// Write over files that truearm did not write, or of another robot
    #[arg(long)]
    force: bool,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

impl Unpack {
    pub fn run(self) -> Result<Said> {
        overwrite::apart([self.out.as_path()], [self.blob.as_path()])?;
        let bytes = read_blob(&self.blob)?;
        let name = self.name.map(|name| Name { name, serial: self.serial });
        let model = unpack(&bytes, &self.blob, name)?;
        overwrite::model_file(&self.out, &model, self.force)?;
        write(&self.out, model.to_sound_toml()?.as_bytes())?;
        if self.json {
            let blob = Blob::check(&bytes).map_err(|e| refused(&self.blob, &bytes, &e.into()))?;
            let files = [&self.blob, &self.out].map(|path| path.display().to_string());
            let (holds, lacks) = (contents(&blob, bytes.len()), not_carried(&model, &bytes));
            return Ok(to_json(&UnpackReport::new(files, holds, lacks)).into());
        }
        let mut text = format!("wrote {}\n", self.out.display());
        text += "a blob does not carry, and the file therefore lacks:\n";
        for line in not_carried(&model, &bytes) {
            text += &format!("  {line}\n");
        }
        Ok(text.into())
    }
}
