//! Whether a gross mistake is behind a fit that failed, or that ended where no sound arm does.

use super::check;
use super::explanations::{SENSELESS, UNBELIEVABLE};
use super::finding::Verdict;
use super::words::together;
use crate::error::{Error, ErrorKind};
use crate::identify::Figures;
use crate::methods::Comparison;
use crate::model::{Measurements, Robot};
use crate::units::{from_mm, to_mm};

/// From here on it is worth a look whether a mistake is behind them: poorly made
/// arms of seven joints have 20.
const SUSPICIOUS_TOLERANCES: f64 = 40.0;
/// A single correction beyond is of the size of gross mistakes, tolerances: 2 cm, or
/// 1.1 degrees.
const LARGE_TOLERANCES: f64 = 20.0;

/// An error of a fit, with what `check` has to say of the files.
#[must_use]
pub fn explained(error: Error, robot: &Robot, data: &Measurements) -> Error {
    let kinds = [ErrorKind::NotConverged, ErrorKind::Contradiction, ErrorKind::Singular];
    if !kinds.contains(&error.kind()) {
        return error;
    }
    match found(robot, data) {
        Some(found) => {
            let help = format!("{found}\n{}", error.help());
            Error::data(error.kind(), error.to_string(), help)
        }
        None => error,
    }
}

/// Where a fit ended.
#[derive(Clone, Copy)]
pub struct Ended {
    /// Norm of the corrections, tolerances.
    norm: f64,
    /// The largest of them.
    largest: f64,
    /// Misfit, m.
    rms: f64,
}

impl Ended {
    /// Of `identify` or `diagnose`.
    #[must_use]
    pub fn of(figures: &Figures) -> Self {
        Self {
            norm: figures.correction_norm,
            largest: figures.largest_correction,
            rms: figures.identified.map_or(0.0, |stats| from_mm(stats.rms_mm)),
        }
    }

    /// Of the method that `identify` has; none where it broke down.
    #[must_use]
    pub fn of_methods(compared: &Comparison) -> Option<Self> {
        let method = compared.methods.iter().find(|method| method.name == "RPIM")?;
        Some(Self {
            norm: method.correction_norm?,
            largest: method.largest_correction?,
            rms: from_mm(method.fitted?.rms_mm),
        })
    }
}

/// A remark where a fit ended at figures that make no sense.
#[must_use]
pub fn remark(ended: Ended, robot: &Robot, data: &Measurements) -> Option<String> {
    let Ended { norm, largest, rms } = ended;
    if norm <= SUSPICIOUS_TOLERANCES && largest <= LARGE_TOLERANCES && rms <= SENSELESS {
        return None;
    }
    let what = if rms > SENSELESS {
        format!("a misfit of {:.0} mm RMS is left", to_mm(rms))
    } else if largest > LARGE_TOLERANCES && norm <= UNBELIEVABLE {
        format!("the largest correction is {largest:.0} tolerances")
    } else {
        format!("the corrections are {norm:.0} tolerances")
    };
    let few = norm <= UNBELIEVABLE && largest <= LARGE_TOLERANCES && rms <= SENSELESS;
    let why = match found(robot, data) {
        Some(why) => why,
        None if few => return None,
        None => "no gross mistake explains it".to_owned(),
    };
    Some(format!("{}: {what}, more than a sound arm has: {why}", data.path.display()))
}

/// What `check` finds, in a sentence; `None` where it finds nothing.
fn found(robot: &Robot, data: &Measurements) -> Option<String> {
    let finding = check(robot, data);
    if finding.too_few.is_some() {
        return None;
    }
    let many = finding.stray.as_ref().filter(|stray| stray.many);
    let words = match finding.verdict {
        // A few rows may be wrong in a sound file.
        Verdict::Sound => {
            let stray = finding.stray.as_ref()?;
            format!("{stray}: correct what was written there, or leave it out")
        }
        Verdict::NotUnderstood if many.is_some() => {
            many.map(ToString::to_string).unwrap_or_default()
        }
        Verdict::Mendable => format!(
            "{}; with that mended {:.2} mm RMS are left: `truearm check {} {} --fix DIR` mends it",
            together(&finding.said),
            to_mm(finding.rms_after),
            robot.path.display(),
            data.path.display(),
        ),
        Verdict::NotUnderstood => format!(
            "robot and measurements disagree by {:.0} mm RMS and no one or two mistakes explain it: \
             are they of the same arm?",
            to_mm(finding.rms_before),
        ),
    };
    Some(words)
}
