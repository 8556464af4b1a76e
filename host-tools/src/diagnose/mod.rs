//! Find, name, add, show: what rigid geometry cannot explain.
//!
//! robust geometric fit -> *where* the residuals are -> *what* explains them
//! ([`weigh`]) -> *show* the gap shrink on held-out poses -> verdict on what is
//! left.

mod bending;
mod beside;
pub mod candidates;
mod chi_square;
mod crowd;
mod described;
mod effect;
mod kind_noise;
pub mod moments;
mod mounting;
mod naming;
mod node;
mod noise_remarks;
mod onset;
mod options;
mod orders;
mod outcome;
mod pipeline;
pub mod policy;
pub mod question;
mod remarks;
mod rounding;
mod show;
mod shown;
mod tell;
mod torques;
mod verdict;
pub mod weigh;
mod weighing;
mod white;

pub use described::{Described, ErrorCourse};
pub use effect::{Coefficient, Effect};
pub use naming::said;
pub use options::DiagnoseOptions;
pub use outcome::{Alternative, GapRow, GapUnit, Outcome, Verdict};
pub use shown::Diagnosis;
pub use tell::{instead, late, otherwise, place};
pub use weigh::Doubt;

use crate::error::{ErrorKind, Result};
use crate::evaluate::not_fitted;
use crate::identify::fit::robust::Crowd;
use crate::identify::start::{cameras, zeros};
use crate::identify::{Options, Problem, Scaling, blamed, enough};
use crate::model::{Measurements, ModelTerm, Robot};
use pipeline::diagnosed;
use torques::same_torques;

/// Names what is missing in the geometry of `robot`. `holdout` poses are never
/// fitted; they only show.
///
/// # Errors
/// As for `identify` and [`DiagnoseOptions::sensible`], and a hold-out file of unknown stations
/// or of rows that are fitted; but rows that contradict each other are no error here, they are
/// what is shown.
pub fn diagnose(
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    options.sensible()?;
    if let Some(held) = holdout {
        same_torques(robot, data, held)?;
        not_fitted(&data.path.display().to_string(), data.shared(held), held)?;
    }
    // An effect of the arm and a wrong zero of an instrument look like each other.
    let few = Options { allow_few_poses: options.allow_few_poses, ..Options::default() };
    let affordable =
        |freed: &Measurements| enough(&Problem::new(freed, robot, Scaling::Prior), &few).is_ok();
    let freed = zeros::freed(data).filter(affordable);
    let with_zeros = |held| freed.as_ref().map(|freed| zeros::as_found(held, &freed.instruments));
    let held = holdout.and_then(with_zeros);
    let (data, holdout) = (freed.as_ref().unwrap_or(data), held.as_deref().or(holdout));
    let of = |data: &Measurements| whatever_holds(robot, data, holdout, options, progress);
    let found = of(data);
    let Some(other) = cameras::freed(robot, data).filter(affordable) else { return found };
    match of(&other) {
        Ok(other) if found.as_ref().is_ok_and(|found| found.misses() <= other.misses()) => found,
        Ok(mut other) => {
            let cameras = cameras::found(&data.instruments, &other.model.instruments);
            other.outcome.figures.warnings.extend(cameras);
            Ok(other)
        }
        Err(_) => found,
    }
}

fn needs_masses(term: &ModelTerm) -> bool {
    matches!(term, ModelTerm::Arm(own) if own.needs_masses())
}

/// However the arm is mounted, and if more rows are off than can be gross errors.
fn whatever_holds(
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    let with = |crowd, mounting| {
        let of =
            |robot: &Robot| diagnosed(robot, data, holdout, options, (crowd, mounting), progress);
        // What torques that were read say of masses counts where something gives way that is no
        // joint; else springs follow what is read.
        let weighed = weighing::weighed(robot, data, mounting).map(|robot| of(&robot));
        let moved = |found: &Diagnosis| found.state.terms.iter().any(needs_masses);
        match weighed {
            Some(Ok(found)) if moved(&found) => Ok(found),
            _ => of(robot),
        }
    };
    let mounted = |mounting| match with(Crowd::Refused, mounting) {
        Err(error) if error.kind() == ErrorKind::Contradiction => with(Crowd::Described, mounting),
        done => done,
    };
    mounting::tried(&mounted).map_err(|error| blamed(robot, data, error))
}
