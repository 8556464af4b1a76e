use std::path::PathBuf;

use clap::Args;
use truearm_host::Result;
use truearm_host::files::write;
use truearm_host::reproduce::{CAUTION, reproduce};

use super::Said;
use super::progress::Bar;

/// The paper's experiment on simulated cells: its tables and figures, and a discussion.
#[derive(Args)]
pub struct Reproduce {
    /// Write report.md, report.json, figures and a cell's files into this folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Simulated cells
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    seeds: u64,
}

impl Reproduce {
    pub fn run(self) -> Result<Said> {
        let bar = Bar::new("simulating");
        let done = reproduce(self.seeds, &|done, total| bar.update(done, total));
        bar.finish();
        let done = done?;
        for (name, text) in &done.files {
            write(&self.out.join(name), text.as_bytes())?;
        }
        let text = format!(
            "{CAUTION}\n{} seeds; RMS on noise-free poses / Cramer-Rao bound, mean: {:.3}\n\
             wrote {} files, first {}\n",
            self.seeds,
            done.study.mean_rms_over_cramer_rao,
            done.files.len(),
            self.out.join("report.md").display()
        );
        Ok(text.into())
    }
}
