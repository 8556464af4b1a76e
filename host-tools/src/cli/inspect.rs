use std::path::PathBuf;

use clap::Args;
use truearm::blob::{Acceptance, Blob};
use truearm_host::Result;
use truearm_host::blob::{contents, describe};
use truearm_host::files::read_key;
use truearm_host::model::Robot;
use truearm_host::report::{InspectReport, to_json};

use super::{End, Said, read_blob, refused, warn};

/// Print every field of a parameter blob, or why a controller would refuse it.
#[derive(Args)]
pub struct Inspect {
    /// The blob
    blob: PathBuf,
    /// Is it this robot's? robot.toml or model.toml
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// Was it written with this key? 32 bytes or 64 hexadecimal digits
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,
    /// Is it at least of this sequence number, that of the blob in force?
    #[arg(long, value_name = "SEQUENCE")]
    not_before: Option<u32>,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

impl Inspect {
    pub fn run(self) -> Result<Said> {
        let bytes = read_blob(&self.blob)?;
        let refused = |e| refused(&self.blob, &bytes, &e);
        let blob = Blob::check(&bytes).map_err(|e| refused(e.into()))?;
        let mut text = describe(&blob, bytes.len(), self.key.is_some());

        let mut asked = Vec::new();
        let mut acceptance = Acceptance::of(blob.robot_id(), blob.joints());
        if let Some(path) = &self.robot {
            let robot = Robot::read(path)?;
            warn(&robot.warnings);
            acceptance = Acceptance::of(
                truearm::blob::robot_id(&robot.name, &robot.serial),
                robot.joints.len(),
            );
            asked.push(format!("robot {} {}", robot.name, robot.serial));
        }
        if let Some(path) = &self.key {
            acceptance = acceptance.with_key(read_key(path)?);
            asked.push(format!("key {}", path.display()));
        }
        if let Some(sequence) = self.not_before {
            acceptance = acceptance.not_before(sequence);
            asked.push(format!("sequence {sequence} in force"));
        }
        let judged = acceptance.judge(&blob);
        if self.json {
            let why = judged.as_ref().err().map(ToString::to_string);
            let file = self.blob.display().to_string();
            let holds = contents(&blob, bytes.len());
            text = to_json(&InspectReport::new(file, holds, asked.clone(), why));
        }
        if let Err(refusal) = judged {
            // What it is helps to see why it is refused.
            return Ok(Said { end: End::Failed(refused(refusal)), ..text.into() });
        }
        if self.json {
            return Ok(text.into());
        }
        if !asked.is_empty() {
            text += &format!("\naccepted by a controller with: {}\n", asked.join(", "));
        }
        Ok(text.into())
    }
}
