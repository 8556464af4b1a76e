//! The paper's experiment on simulated cells, many times over, and what of its
//! printed figures can be understood from that.

pub mod arm;
pub mod cell;
mod discussion;
mod example;
mod figures;
pub mod paper;
mod points;
mod section_v;
mod text;
mod trial;

pub use trial::{Contest, Diagnosis, Score, Sweep, Trial, cramer_rao};

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use truearm_host::error::Result;
use truearm_host::identify::Progress;
use truearm_host::identify::robust::median;

/// The seed whose figures are drawn.
pub const SHOWN: u64 = 1;

/// The whole study.
#[derive(Debug, Clone, Serialize)]
pub struct Study {
    /// `truearm-reproduce-1`
    pub schema: &'static str,
    /// The verb.
    pub command: &'static str,
    /// Said first wherever these figures appear.
    pub caution: &'static str,
    /// Mean over seeds of RMS on noise-free poses over the Cramer-Rao bound.
    pub mean_rms_over_cramer_rao: f64,
    /// One entry a seed.
    pub trials: Vec<Trial>,
}

/// First line of every report.
pub const CAUTION: &str = "Simulated figures are not comparable with a real arm's: they show how methods behave, not how good an arm becomes.";

/// A study and the files that show it.
pub struct Reproduction {
    /// The figures.
    pub study: Study,
    /// File names and texts.
    pub files: Vec<(String, String)>,
}

/// Runs seeds 1 to `seeds`.
///
/// # Errors
/// When a simulated cell cannot be identified.
pub fn reproduce(seeds: u64, progress: Progress) -> Result<Reproduction> {
    let done = AtomicUsize::new(0);
    let trials: Result<Vec<Trial>> = (1..=seeds)
        .into_par_iter()
        .map(|seed| {
            let trial = trial::run(seed);
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, seeds as usize);
            trial
        })
        .collect();
    let trials = trials?;
    let ratios = trials.iter().map(|t| t.rms_mm / t.cramer_rao_mm);
    let study = Study {
        schema: "truearm-reproduce-1",
        command: "reproduce",
        caution: CAUTION,
        mean_rms_over_cramer_rao: ratios.sum::<f64>() / trials.len() as f64,
        trials,
    };
    let example = example::Example::new(SHOWN)?;
    let nine = section_v::nine_poses(SHOWN)?;
    let mut files = vec![("report.md".to_owned(), text::report(&study, &example, &nine))];
    let json = serde_json::to_string_pretty(&study);
    let json = json.unwrap_or_else(|e| unreachable!("a plain struct: {e}"));
    files.push(("report.json".to_owned(), json + "\n"));
    files.extend(figures::all(&study, &example, &nine));
    let cell = example.cell.files.iter();
    files.extend(cell.map(|(name, text)| (format!("cell/{name}"), text.clone())));
    Ok(Reproduction { study, files })
}

/// Median, tenth and ninetieth percentile, largest.
fn spread(values: &[f64]) -> [f64; 4] {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let index = (share * (sorted.len().max(1) - 1) as f64).round() as usize;
        sorted.get(index).copied().unwrap_or(f64::NAN)
    };
    let middle = if sorted.is_empty() { f64::NAN } else { median(&sorted) };
    [middle, at(0.1), at(0.9), at(1.0)]
}
