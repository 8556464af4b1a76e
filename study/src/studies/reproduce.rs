//! The paper's experiment, written as files.

use std::path::PathBuf;

use clap::Args;
use indicatif::ProgressBar;
use truearm_host::files::write;

use super::Result;
use crate::reproduce::{CAUTION, reproduce};

#[derive(Args)]
pub struct Options {
    /// Write report.md, report.json, figures and a cell's files into this folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Simulated cells
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    seeds: u64,
}

pub fn run(options: &Options) -> Result {
    let bar = ProgressBar::new(options.seeds);
    let done = reproduce(options.seeds, &|done, _| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    for (name, text) in &done.files {
        write(&options.out.join(name), text.as_bytes())?;
    }
    println!("{CAUTION}");
    println!(
        "{} seeds; RMS on noise-free poses / Cramer-Rao bound, mean: {:.3}",
        options.seeds, done.study.mean_rms_over_cramer_rao
    );
    let first = options.out.join("report.md");
    println!("wrote {} files, first {}", done.files.len(), first.display());
    Ok(())
}
