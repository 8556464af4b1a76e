//! All seeds together, and how their figures are looked up and summed up.

use serde::Serialize;
use truearm_host::statistics::median;

use super::trial::{Contest, Score, Trial};

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

type Of = fn(&Trial) -> &Contest;

/// The four contests.
pub fn contests() -> [(&'static str, Of); 4] {
    [
        ("(a) geometric errors only, base and tool fitted", |t| &t.geometric[0]),
        ("(a) geometric errors only, base and tool held", |t| &t.geometric[1]),
        ("(b) springs and gears, base and tool fitted", |t| &t.beyond[0]),
        ("(b) springs and gears, base and tool held", |t| &t.beyond[1]),
    ]
}

/// A method's score.
pub fn score<'a>(contest: &'a Contest, name: &str) -> Option<&'a Score> {
    contest.scores.iter().find(|s| s.method == name)
}

/// Median, tenth and ninetieth percentile, largest.
pub fn spread(values: &[f64]) -> [f64; 4] {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let index = (share * (sorted.len().max(1) - 1) as f64).round() as usize;
        sorted.get(index).copied().unwrap_or(f64::NAN)
    };
    let middle = if sorted.is_empty() { f64::NAN } else { median(&sorted) };
    [middle, at(0.1), at(0.9), at(1.0)]
}
