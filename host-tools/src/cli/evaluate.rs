use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truearm_host::Result;
use truearm_host::evaluate::{Reregister, evaluate, not_covered};
use truearm_host::model::{Measurements, Model};
use truearm_host::report::{EvaluateReport, to_json};

use super::{Said, warn, words};

/// Score a model on measurements it was not identified from.
#[derive(Args)]
pub struct Evaluate {
    /// model.toml of `identify`
    model: PathBuf,
    /// Measurements of any kind
    data: PathBuf,
    /// Fit these on the file itself, for another tracker station or target
    #[arg(long, value_enum)]
    reregister: Option<Frames>,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

/// What may be fitted on the scored file.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum Frames {
    /// Each station's base
    Base,
    /// Each station's base and each marker
    #[value(name = "base+tool")]
    BaseAndTool,
}

impl From<Frames> for Reregister {
    fn from(frames: Frames) -> Self {
        match frames {
            Frames::Base => Self::Base,
            Frames::BaseAndTool => Self::BaseAndTool,
        }
    }
}

impl Evaluate {
    pub fn run(self) -> Result<Said> {
        let model = Model::read(&self.model)?;
        let data = Measurements::read(&self.data, &model.robot)?;
        warn(&data.warnings);
        let frames = self.reregister.map(Into::into).unwrap_or_default();
        let validation = evaluate(&model, &data, frames).inspect_err(|_| {
            // Whoever mends the frames should know this as well.
            warn(&words::not_covered(&not_covered(&model, &data)).into_iter().collect::<Vec<_>>());
        })?;
        if self.json {
            let model = self.model.display().to_string();
            let report = EvaluateReport::new(model, validation, data.warnings);
            return Ok(to_json(&report).into());
        }
        Ok(words::validation(&validation).into())
    }
}
