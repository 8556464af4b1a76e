//! What an instrument adds to every length, found where nobody said that it might: a wire
//! that leaves its drum before its zero, balls that are not where the bar ends. As a known
//! nothing it bends the arm, and looks like an effect of it.

use super::registration::register;
use crate::identify::fit::robust::{Flags, robust_fit};
use crate::identify::noise_estimate;
use crate::identify::problem::{Problem, Scaling, Unknown};
use crate::model::{Form, Instrument, Measurements, Robot};
use crate::observations::kind;
use crate::tikhonov::covariance;

/// Standard deviations beyond which it is no chance. The arm may lack an effect that looks a
/// little like it: then it is an unknown too many, which costs next to nothing.
const SURE: f64 = 5.0;
/// Lengths to one anchor that may tell its place, an offset and something of the arm.
const ENOUGH: usize = 8;

/// What is added to the lengths to some anchors.
pub struct Zeros {
    labels: Vec<String>,
    /// A sentence an anchor that something is added to.
    pub words: Vec<String>,
}

impl Zeros {
    /// Measurements in which these are unknown.
    #[must_use]
    pub fn freed(&self, data: &Measurements) -> Measurements {
        freed(data, &self.labels)
    }
}

/// What is added to lengths beyond chance, of measurements in which that is known to be
/// nothing; `None` where it is nothing or cannot be told.
#[must_use]
pub fn found(robot: &Robot, data: &Measurements) -> Option<Zeros> {
    let labels = anchors(data);
    if labels.is_empty() {
        return None;
    }
    let open = freed(data, &labels);
    let problem = Problem::new(&open, robot, Scaling::Prior);
    let start = register(&open, &problem.nominal, robot.tool).ok()?;
    let mut problem = problem.about(&start);
    let rows = problem.counted();
    problem.noise = noise_estimate::noise(&problem, &rows, &start).ok()?;
    let found = robust_fit(&problem, &rows, &start, Flags::default()).ok()?;
    let cov = covariance(&found.fit.normal, problem.unknowns.free(), 1.0);
    let zero = |(k, unknown): (usize, &Unknown)| {
        let Unknown::Instrument(i, ..) = unknown else { return None };
        let own = &found.fit.state.instruments[*i];
        let sd = found.scale * cov[(k, k)].max(0.0).sqrt() * problem.unit(*unknown);
        (own.form == Form::Zero).then(|| (own.label.clone(), own.numbers[0], sd))
    };
    let zeros = problem.unknowns.list().iter().enumerate().filter_map(zero);
    let (sure, _): (Vec<_>, Vec<_>) = zeros.partition(|(_, added, sd)| added.abs() > SURE * sd);
    let words = sure.iter().map(|(label, added, sd)| {
        format!(
            "lengths to anchor \"{label}\" have {:+.3} mm (+-{:.3}) added to each, which its place \
             does not explain: the zero of the instrument",
            added * 1e3,
            2.0 * sd * 1e3
        )
    });
    let words: Vec<String> = words.collect();
    (!words.is_empty()).then_some(Zeros { labels, words })
}

/// Anchors that enough lengths are measured to, of whose zero nothing is stated.
fn anchors(data: &Measurements) -> Vec<String> {
    let is_own = |i: usize| {
        let own = data.rows.iter().filter(|row| kind(row).has_zero() && row.refers[..] == [i]);
        own.count() >= ENOUGH
    };
    let anchors = data.instruments.iter().enumerate().filter(|(i, own)| {
        own.form == Form::Anchor && is_own(*i)
    });
    anchors.map(|(_, own)| own.label.clone()).collect()
}

/// Measurements in which what is added to lengths to some anchors is unknown.
fn freed(data: &Measurements, labels: &[String]) -> Measurements {
    let mut out = data.clone();
    for label in labels {
        let is_own = |own: &Instrument| own.form == Form::Anchor && own.label == *label;
        let Some(anchor) = data.instruments.iter().position(is_own) else { continue };
        let zero = out.instruments.len();
        out.instruments.push(Instrument { stated: true, ..Instrument::unknown(Form::Zero, label) });
        let rows = out.rows.iter_mut().filter(|row| kind(row).has_zero());
        rows.filter(|row| row.refers[..] == [anchor]).for_each(|row| row.refers.push(zero));
    }
    out
}
