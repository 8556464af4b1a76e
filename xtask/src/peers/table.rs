//! Times of all programs, as ratios to truearm's of the same run.

use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Nanoseconds a pose, by what was computed and by whom: one a round.
#[derive(Default)]
pub struct Table(BTreeMap<(String, String), Vec<f64>>);

/// What peers compute, what they are compared with, and the words for it.
const ROWS: [(&str, &[&str], &str); 5] = [
    ("forward", &["forward", "batch-f64", "batch-f32"], "pose"),
    ("batch", &["batch-f64", "batch-f32"], "pose, all at once"),
    ("jacobian", &["jacobian"], "pose and Jacobian"),
    ("columns", &["columns"], "derivatives to all parameters"),
    ("wrist", &["wrist"], "pose, another arm, with spherical wrist"),
];
const OURS: &str = "truearm";

impl Table {
    /// Takes the lines `time PEER WHAT NS` of a program.
    pub fn add(&mut self, output: &str) {
        for line in output.lines() {
            let words: Vec<_> = line.split_whitespace().collect();
            if let ["time", peer, what, value] = words[..]
                && let Ok(value) = value.parse()
            {
                self.0.entry((what.to_owned(), peer.to_owned())).or_default().push(value);
            }
        }
    }

    /// Least and median.
    fn figures(&self, what: &str, peer: &str) -> Option<[f64; 2]> {
        let mut times = self.0.get(&(what.to_owned(), peer.to_owned()))?.clone();
        times.sort_by(f64::total_cmp);
        Some([*times.first()?, *times.get(times.len() / 2)?])
    }

    pub fn text(&self, rounds: usize) -> String {
        let mut out = format!("\nns a pose, least and median of {rounds} rounds\n\n");
        for (what, peer) in self.0.keys() {
            if let Some([least, median]) = self.figures(what, peer) {
                let _ = writeln!(out, "{what:12} {peer:20} {least:11.1} {median:11.1}");
            }
        }
        out += "\ntruearm is as many times as fast (ratio of the least, of the medians)\n\n";
        for (theirs, ours, words) in ROWS {
            for (_, peer) in self.0.keys().filter(|(what, _)| what == theirs) {
                if peer == OURS {
                    continue;
                }
                for own in ours {
                    self.compare(&mut out, (theirs, peer), own, words);
                }
            }
        }
        out
    }

    fn compare(&self, out: &mut String, (theirs, peer): (&str, &str), own: &str, words: &str) {
        let figures = (self.figures(theirs, peer), self.figures(own, OURS));
        if let (Some([least, median]), Some([own_least, own_median])) = figures {
            let ratios = [least / own_least, median / own_median];
            let _ = writeln!(
                out,
                "{peer:20} {words:40} {own:10} {:10.2} {:10.2}",
                ratios[0], ratios[1]
            );
        }
    }
}
