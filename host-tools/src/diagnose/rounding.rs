//! Joint values that were written with few digits: what was read is off by what rounding took.

use truearm::JointKind;

use super::node::Node;
use super::weigh::Scattered;
use crate::identify::{Problem, Scatterer};
use crate::units::{joint_from_file, joint_micro, joint_unit};

/// Distinct values that tell: a few of a plan are round by themselves.
const ENOUGH: usize = 10;
/// Digits behind the point that are looked for.
const DIGITS: i32 = 4;
/// A value is round that is no farther off, as a share of the last digit.
const NEAR: f64 = 1e-3;
/// A joint that scatters by so many times what rounding does scatters by that: as it is found
/// from residuals it is true to a fifth or so. No study set them.
const AS_ROUNDING: std::ops::Range<f64> = 0.6..1.5;

/// Rounding that makes so much of the noise that was found, as a share of it, is worth a word;
/// what would make more is none, but values that were asked for. No study set them.
const WORTH_A_WORD: std::ops::Range<f64> = 0.5..1.3;

/// So many rows say as well as all what rounding makes at the target.
const LOOKS: usize = 1000;

/// The last digit that all values of a joint have.
struct Last {
    /// rad or m.
    step: f64,
    /// As it is written, with its unit.
    words: String,
}

impl Last {
    /// Of a joint, counted from 0; none of values that are not round.
    fn of(problem: &Problem, joint: usize) -> Option<Self> {
        let kind = problem.nominal[joint].kind;
        let mut values: Vec<f64> = problem.data.rows.iter().map(|row| row.q[joint]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        if values.len() < ENOUGH {
            return None;
        }
        let in_file = (joint_from_file(kind, 1.0), joint_unit(kind));
        let radians = (kind == JointKind::Revolute).then_some((1.0, "rad"));
        let is_round =
            |step: f64| values.iter().all(|v| (v / step - (v / step).round()).abs() < NEAR);
        let of_unit = |(unit, word): (f64, &str)| {
            (0..=DIGITS).find_map(|digits| {
                let written = 10f64.powi(-digits);
                let step = unit * written;
                let words = format!("{written:.*} {word}", digits as usize);
                is_round(step).then_some(Self { step, words })
            })
        };
        let all = std::iter::once(in_file).chain(radians).filter_map(of_unit);
        all.max_by(|a, b| a.step.total_cmp(&b.step))
    }

    /// Standard deviation of what was rounded off, rad or m.
    fn scatter(&self) -> f64 {
        self.step / f64::sqrt(12.0)
    }
}

/// Rounding that scatters a joint, counted from 0, by about so much, rad or m, one standard
/// deviation, in words.
#[must_use]
pub fn explains(problem: &Problem, joint: usize, size: f64) -> Option<String> {
    let last = Last::of(problem, joint)?;
    let unit = joint_micro(problem.nominal[joint].kind);
    AS_ROUNDING.contains(&(size / last.scatter())).then(|| {
        let (words, alone) = (&last.words, last.scatter() * 1e6);
        format!("its values are written to {words}, which alone scatters them by {alone:.0} {unit}")
    })
}

/// A remark where rounding of all joints may be much of the noise that the problem's rows have.
#[must_use]
pub fn remark(problem: &Problem, best: &Node) -> Option<String> {
    let joints: Vec<(usize, Last)> = (0..problem.nominal.len())
        .filter_map(|joint| Some((joint, Last::of(problem, joint)?)))
        .collect();
    let words = &joints.iter().max_by(|a, b| a.1.step.total_cmp(&b.1.step))?.1.words;
    let ratio = |(joint, last): &(usize, Last)| (Scatterer::Joint(*joint), last.scatter().powi(2));
    let ratios: Vec<(Scatterer, f64)> = joints.iter().map(ratio).collect();
    let fit = &best.fit;
    let every = fit.kept.len().div_ceil(LOOKS).max(1);
    let rows: Vec<usize> = fit.kept.iter().copied().step_by(every).collect();
    let together = Scattered::of(problem, &fit.fit.state, &rows, &ratios).together();
    let share = (together * together - 1.0).max(0.0).sqrt();
    WORTH_A_WORD.contains(&share).then(|| {
        format!(
            "{}: joint values are written to {words}: if they were rounded, that alone is {:.0} % of \
             the noise: write more digits",
            problem.data.path.display(),
            share.min(1.0) * 100.0
        )
    })
}
