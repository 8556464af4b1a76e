//! How far the nominal arm is from every reading of the numbers: distances between
//! points are the same in every frame.

use nalgebra::Vector3;
use truearm::JointKind;

use super::clues::{Clues, Found, Place};
use crate::headings::{Quantity, Unit};
use crate::import::agreement;
use crate::import::join::RowRef;
use crate::model::Robot;
use crate::units::{from_mm, joint_from_file};

/// A unit and why.
pub(super) type Told = (Unit, String);

/// A reading is the arm's if distances agree as well as this (median of the
/// logarithm: an eighth) and the other reading is off by twice as much at least.
/// Sound files have 1 % to 8 %, the larger where the tool is not stated; gons
/// taken for degrees are off by 6 % to 13 %, half of a file in another unit by 30 %.
pub(super) const AGREES: f64 = 0.12;
/// Units of angles that an arm may settle; nobody means a milliradian in silence.
const ANGLES: [Unit; 3] = [Unit::Deg, Unit::Rad, Unit::Gon];
/// The same of lengths.
const LENGTHS: [Unit; 6] = [Unit::Mm, Unit::M, Unit::Cm, Unit::Um, Unit::Inch, Unit::Foot];
/// Points span no more than this many times all lengths of an arm, and no less than
/// this part of it.
const SPANS: [f64; 2] = [5e-3, 2.6];

/// So many rows tell units; distances need no more.
const ROWS: usize = 1000;

/// What a reading is of: units of columns that do not say theirs, and how far it is
/// off: the median logarithm of the ratio of distances.
struct Reading {
    angle: Unit,
    length: Unit,
    misfit: f64,
}

/// All readings.
pub(super) struct Readings(Vec<Reading>);

impl Readings {
    /// `said`: units that columns say themselves, of joints and of x, y, z.
    pub fn of(
        clues: &Clues,
        found: &Found,
        quantities: &[Quantity],
        rows: &[RowRef],
        said: &[Option<Unit>],
    ) -> Self {
        let Some(robot) = clues.robot.filter(|_| !found.point.is_empty()) else {
            return Self(Vec::new());
        };
        let places: Vec<&Place> = found.joints.iter().chain(&found.point).collect();
        let all = clues.numbers(&places, rows);
        let values: Vec<&Vec<f64>> = all.iter().step_by(all.len() / ROWS + 1).collect();
        let n = found.joints.len();
        let (mut all, mut of_far) = (Vec::new(), Vec::new());
        for (angle, length) in ANGLES.iter().flat_map(|a| LENGTHS.map(|l| (*a, l))) {
            let joint = |(j, v): (usize, &f64)| match quantities[j] {
                Quantity::Length => {
                    let unit = said[j].unwrap_or(length);
                    joint_from_file(JointKind::Prismatic, unit.to_file(*v))
                }
                _ => said[j].unwrap_or(angle).to_file(*v).to_radians(),
            };
            let q: Vec<Vec<f64>> =
                values.iter().map(|v| v[..n].iter().enumerate().map(joint).collect()).collect();
            let axis = |v: &Vec<f64>, i: usize| said[n + i].unwrap_or(length).to_file(v[n + i]);
            let point = |v: &&Vec<f64>| Vector3::from_fn(|i, _| from_mm(axis(v, i)));
            let points: Vec<_> = values.iter().map(point).collect();
            for (readings, far) in [(&mut all, false), (&mut of_far, true)] {
                let misfit = agreement::distances(robot, &q, &points, far);
                readings.extend(misfit.map(|misfit| Reading { angle, length, misfit }));
            }
        }
        // Where half of all distances are small, these say nothing; else they say most.
        let agrees = |all: &[Reading]| all.iter().any(|reading| reading.misfit < AGREES);
        Self(if agrees(&all) || !agrees(&of_far) { all } else { of_far })
    }

    /// The best reading, where it agrees, and the best that differs by `key`.
    fn best(&self, key: impl Fn(&Reading) -> Unit) -> Option<Told> {
        let best = self.0.iter().min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
        let others = self.0.iter().filter(|r| key(r) != key(best));
        let other = others.map(|r| r.misfit).fold(f64::INFINITY, f64::min);
        let clear = best.misfit < AGREES && other > 2.0 * best.misfit && other.is_finite();
        let percent = |misfit: f64| 100.0 * misfit.exp_m1();
        let words = || {
            format!(
                "distances between the points are those of the nominal arm within {:.0} % (otherwise {:.0} %)",
                percent(best.misfit).ceil(),
                percent(other)
            )
        };
        clear.then(|| (key(best), words()))
    }

    pub fn joints(&self) -> Option<Told> {
        self.best(|r| r.angle)
    }

    pub fn points(&self) -> Option<Told> {
        self.best(|r| r.length)
    }

    /// Whether the arm tells nothing because no reading agrees; how far the best is
    /// off, percent.
    pub fn none_agrees(&self) -> Option<f64> {
        let best = self.0.iter().map(|r| r.misfit).fold(f64::INFINITY, f64::min);
        (best.is_finite() && best >= AGREES).then(|| 100.0 * best.exp_m1())
    }

    /// Where the arm contradicts what a heading says or a flag asks for.
    pub fn contradiction(what: &str, known: &Told, arm: Option<Told>) -> Option<String> {
        let (unit, because) = known;
        let (other, words) = arm.filter(|(other, _)| other != unit)?;
        Some(format!(
            "{what} are taken in {}, because {because}; but in {} {words}",
            unit.word(),
            other.word()
        ))
    }
}

/// Lengths in which points of this span are within the arm's reach.
pub(super) fn within_reach(robot: &Robot, span: f64) -> Vec<Unit> {
    let reach = robot.reach();
    let fits = |unit: &Unit| {
        let metres = from_mm(unit.to_file(span));
        metres <= SPANS[1] * reach && metres >= SPANS[0] * reach
    };
    LENGTHS.into_iter().filter(fits).collect()
}
