use std::path::PathBuf;

use clap::Args;
use truearm_host::Result;
use truearm_host::files::{Model, write};
use truearm_host::pack::{notes, pack};

/// Pack a model into a parameter blob for the controller.
#[derive(Args)]
pub struct Pack {
    /// model.toml of `identify`
    model: PathBuf,
    /// The blob to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Sequence number; the model's creation time in Unix seconds if not given
    #[arg(long)]
    sequence: Option<u32>,
}

impl Pack {
    pub fn run(self) -> Result<()> {
        let model = Model::read(&self.model)?;
        let bytes = pack(&model, self.sequence)?;
        write(&self.out, &bytes)?;
        println!("wrote {}: {} bytes", self.out.display(), bytes.len());
        for note in notes(&model) {
            println!("{note}");
        }
        println!(
            "frame: commanded poses refer to the nominal base; residual base {:.3} {:.3} {:.3} mm",
            model.frame_translation.x * 1e3,
            model.frame_translation.y * 1e3,
            model.frame_translation.z * 1e3
        );
        println!("flange orientation: not identified, points only; it stays nominal");
        if model.markers.len() > 1 {
            println!(
                "tool: marker \"{}\", the first of {}",
                model.markers[0].0,
                model.markers.len()
            );
        }
        if !model.unidentifiable.is_empty() {
            println!("directions the data did not determine, left at or near nominal:");
            for line in &model.unidentifiable {
                println!("  {line}");
            }
        }
        Ok(())
    }
}
