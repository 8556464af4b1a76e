//! What an answer to a blind set was worth.

use std::collections::BTreeSet;

use truearm_host::diagnose::{Effect, Outcome, Verdict};

use super::sets::{BlindSet, LISTED};

/// Names with a place: a joint, a coupled pair or none.
pub type Places = BTreeSet<(String, Vec<usize>)>;

/// What an answer was worth.
#[derive(Debug, Clone)]
pub struct Score {
    pub seed: u64,
    pub truth: Places,
    pub answer: Places,
    pub verdict: Verdict,
    /// Rows from 1: flagged, really wrong, and those whose side of a gap the
    /// stated masses get wrong.
    pub rows: [Vec<usize>; 3],
    /// Reduced chi-square of the answer, and of a fit with the true effects.
    pub reduced: [f64; 2],
    /// Hold-out RMS of the answer over that of a fit with the true effects;
    /// `None` where something unlisted is hidden.
    pub ratio: Option<f64>,
}

fn names(places: &Places) -> BTreeSet<&str> {
    places.iter().map(|p| p.0.as_str()).collect()
}

impl Score {
    /// Whether something no report can name is hidden.
    pub fn unlisted(&self) -> bool {
        names(&self.truth).iter().any(|n| !LISTED.contains(n))
    }

    /// All names found and no other.
    pub fn names_right(&self) -> bool {
        names(&self.truth) == names(&self.answer)
    }

    /// All places found, whatever else was named.
    pub fn joints_right(&self) -> bool {
        let hidden = names(&self.truth);
        let mut there = self.answer.iter().filter(|p| hidden.contains(p.0.as_str()));
        self.truth.is_subset(&self.answer) && there.all(|p| self.truth.contains(p))
    }

    /// Names that are not true.
    pub fn extra(&self) -> usize {
        names(&self.answer).difference(&names(&self.truth)).count()
    }

    /// The verdict that the truth deserves.
    pub fn verdict_right(&self) -> bool {
        self.verdict
            == if self.unlisted() {
                Verdict::Unexplained
            } else if self.truth.is_empty() {
                Verdict::Clean
            } else {
                Verdict::Explained
            }
    }

    /// A false name given with confidence.
    pub fn forced(&self) -> bool {
        self.extra() > 0 && self.verdict == Verdict::Explained
    }
}

/// Names and places that a report is sure of.
pub fn places(report: &Outcome) -> Places {
    of(&report.effects)
}

/// The same with what it only suspects.
pub fn told(report: &Outcome) -> Places {
    of(&report.effects).union(&of(&report.suspected)).cloned().collect()
}

/// Names and places of effects, a place each.
pub fn of(effects: &[Effect]) -> Places {
    let mut out = Places::new();
    for effect in effects {
        let name = effect.name.to_owned();
        let coupled =
            truearm::effects::Effect::from_name(effect.name).is_some_and(|e| e.is_coupled());
        if coupled || effect.joints.is_empty() {
            out.insert((name, effect.joints.clone()));
        } else {
            out.extend(effect.joints.iter().map(|j| (name.clone(), vec![*j])));
        }
    }
    out
}

/// Opens a set and compares.
pub fn score(set: &BlindSet, report: &Outcome) -> Score {
    let secret = set.open();
    let truth: Places =
        secret.arm.defects.iter().map(|d| (d.kind.name().to_owned(), d.kind.joints())).collect();
    let (robot, data, holdout) = set.read();
    let given = secret.fit(&robot, &data, &holdout);
    let answer = report.gap.last().and_then(|row| row.holdout_rms_mm).unwrap_or(f64::NAN) * 1e-3;
    Score {
        seed: set.seed,
        answer: places(report),
        verdict: report.verdict,
        rows: [
            report.figures.outlier_rows.clone(),
            secret.outliers.clone(),
            secret.turned(&robot, &data),
        ],
        reduced: [report.reduced_chi_square, given.map_or(f64::NAN, |g| g[1])],
        ratio: given.map(|g| answer / g[0]),
        truth,
    }
}
