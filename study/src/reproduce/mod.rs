//! The paper's experiment on simulated cells, many times over, and what of its
//! printed figures can be understood from that.

pub mod arm;
pub mod cell;
mod discussion;
mod example;
mod figures;
mod markdown;
pub mod paper;
mod points;
mod report;
mod section_v;
mod study;
mod tables;
mod trial;

pub use study::{CAUTION, SHOWN, Study};
pub use trial::{Contest, Diagnosis, Score, Sweep, Trial, cramer_rao};

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use truearm_host::error::Result;
use truearm_host::identify::Progress;

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
    let figures = figures::all(&study, &example, &nine);
    let text = report::report(&study, &example, &nine, &figures);
    let mut files = vec![("report.md".to_owned(), text)];
    let json = serde_json::to_string_pretty(&study);
    let json = json.unwrap_or_else(|e| unreachable!("a plain struct: {e}"));
    files.push(("report.json".to_owned(), json + "\n"));
    files.extend(figures);
    let cell = example.cell.files.iter();
    files.extend(cell.map(|(name, text)| (format!("cell/{name}"), text.clone())));
    Ok(Reproduction { study, files })
}
