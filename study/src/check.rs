//! Gross mistakes typed into sound sessions: how many does `check` name?

use std::collections::BTreeMap;
use std::time::Instant;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm_host::check::Verdict;
use truearm_host::model::Robot;
use truearm_simulate::robots;

use crate::mistakes::{Mistake, Outcome, Session, drawn, judged};
use crate::simulated::robot;

/// A session, what was typed wrong in it, and what was found.
pub struct Trial {
    pub arm: String,
    pub mistakes: Vec<Mistake>,
    pub outcome: Outcome,
    /// What was said.
    pub said: String,
    /// Time of the check.
    pub seconds: f64,
}

/// A session as good ones are, or as many are.
fn session(robot: &Robot, hard: bool, rng: &mut ChaCha8Rng) -> Session {
    if hard { Session::draw_hard(robot, rng) } else { Session::draw(robot, rng) }
}

/// A session with so many mistakes; which arm and which mistakes are drawn.
///
/// # Panics
/// Where a file cannot be read that was written here.
pub fn trial(seed: u64, mistakes: usize, hard: bool) -> Trial {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let robot = robot(robots::ALL[(seed % robots::ALL.len() as u64) as usize]);
    let clean = session(&robot, hard, &mut rng);
    let mut typed = clean.clone();
    let mut made: Vec<Mistake> = Vec::new();
    while made.len() < mistakes {
        let mistake = drawn(&typed, &mut rng);
        // Two of a kind at one place are one mistake, or none.
        let again = |other: &Mistake| place(other) == place(&mistake);
        if !made.iter().any(again) {
            typed.make(&mistake);
            made.push(mistake);
        }
    }
    let start = Instant::now();
    let finding = typed.checked();
    let seconds = start.elapsed().as_secs_f64();
    let outcome = judged(&clean, &typed, &made, &finding);
    let said: Vec<String> = finding.said.iter().map(ToString::to_string).collect();
    Trial { arm: robot.name, mistakes: made, outcome, said: said.join(", and "), seconds }
}

/// Name of a mistake, and its joint where it has one.
fn place(mistake: &Mistake) -> (String, Option<usize>) {
    let joint = match mistake {
        Mistake::Sense(j) | Mistake::Zero(j, _) | Mistake::Number(j, ..) | Mistake::Sign(j, _) => {
            Some(*j)
        }
        _ => None,
    };
    (name(mistake), joint)
}

/// A mistake as tables call it.
#[must_use]
pub fn name(mistake: &Mistake) -> String {
    match mistake {
        Mistake::Sense(_) => "sense",
        Mistake::Zero(_, by) if by.abs() == 90.0 || by.abs() == 180.0 => "zero, quarter turns",
        Mistake::Zero(..) => "zero, any angle",
        Mistake::Swapped(..) | Mistake::Alphabetical => "order",
        Mistake::Radians | Mistake::SlideInMetres => "unit of joints",
        Mistake::PointsIn(_) => "unit of points",
        Mistake::RobotIn(_) | Mistake::RobotInRadians => "unit of the robot",
        Mistake::StandardTable | Mistake::ShiftedTable => "DH convention",
        Mistake::Number(_, 0, _) | Mistake::Sign(_, 0) => "alpha",
        Mistake::Number(..) => "a length",
        Mistake::Sign(..) => "sign of a length",
        Mistake::Mirrored(_) | Mistake::AxesSwapped(..) => "tracker axes",
        Mistake::OutOfStep(_) => "rows out of step",
    }
    .to_owned()
}

/// Trials of so many seeds from one on.
#[must_use]
pub fn trials(from: u64, count: u64, mistakes: usize, hard: bool) -> Vec<Trial> {
    (from..from + count).into_par_iter().map(|seed| trial(seed, mistakes, hard)).collect()
}

/// Whether an outcome tells the user what is to be known.
#[must_use]
pub fn told(outcome: Outcome) -> bool {
    matches!(outcome, Outcome::Named | Outcome::Equivalent | Outcome::Absorbed)
}

/// Outcomes by some name of a trial.
#[must_use]
pub fn tally(
    trials: &[Trial],
    of: impl Fn(&Trial) -> Vec<String>,
) -> BTreeMap<String, BTreeMap<Outcome, usize>> {
    let mut tally: BTreeMap<String, BTreeMap<Outcome, usize>> = BTreeMap::new();
    for trial in trials {
        for name in of(trial) {
            *tally.entry(name).or_default().entry(trial.outcome).or_default() += 1;
        }
    }
    tally
}

/// Sound sessions from a seed on in which something was found wrong.
#[must_use]
pub fn alarms(from: u64, count: u64, hard: bool) -> Vec<(u64, String)> {
    let of = |seed: u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let robot = robot(robots::ALL[(seed % robots::ALL.len() as u64) as usize]);
        let finding = session(&robot, hard, &mut rng).checked();
        let said: Vec<String> = finding.said.iter().map(ToString::to_string).collect();
        (finding.verdict != Verdict::Sound).then(|| (seed, said.join(", and ")))
    };
    (from..from + count).into_par_iter().filter_map(of).collect()
}
