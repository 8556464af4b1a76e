//! Constants of a camera that are not those it was stated with: a lens that was calibrated at
//! another focus, in other units of distortion. As known numbers they bend the arm, and look
//! like an effect of it.

use super::registration::register;
use crate::identify::fit::robust::{Flags, RobustFit, robust_fit};
use crate::identify::noise_estimate;
use crate::identify::problem::{Problem, Scaling};
use crate::model::{Form, Instrument, Measurements, Robot};
use crate::observations::kind;

/// Numbers of an instrument behind the six of its place.
const NUMBERS: usize = 6;
/// Places in images of one camera that tell its constants and something of the arm.
const ENOUGH: usize = 30;
/// Fall of the squares, over what is left of an equation, beyond which it is no chance, which
/// is nine a camera.
const SURE: f64 = 100.0;
/// And the share of them that may be left: of an effect of the arm, or of what it scatters by,
/// constants take less.
const LEFT: f64 = 0.7;

/// Measurements in which the constants of cameras are unknown that were stated, where they do
/// not fit; `None` where they do, or nothing can be said.
#[must_use]
pub fn freed(robot: &Robot, data: &Measurements) -> Option<Measurements> {
    let rows = |camera: usize| {
        let own = |row: &&crate::model::Row| kind(row).is_image() && row.refers[0] == camera;
        data.rows.iter().filter(own).count()
    };
    let mut open = data.clone();
    let mut any = false;
    for (k, own) in open.instruments.iter_mut().enumerate() {
        let stated = own.form == Form::Camera && !own.free[NUMBERS..].contains(&true);
        if stated && rows(k) >= ENOUGH {
            own.free[NUMBERS..].fill(true);
            any = true;
        }
    }
    if !any {
        return None;
    }
    let [stated, found] = [data, &open].map(|data| fitted(robot, data));
    let (stated, found) = stated.zip(found)?;
    // Of rows that neither has left out.
    let mut both = stated.fit.kept.clone();
    both.retain(|row| found.fit.kept.binary_search(row).is_ok());
    let equations: usize = both.iter().map(|r| kind(&data.rows[*r]).components().len()).sum();
    let [before, after] = [&stated, &found].map(|fitted| fitted.left(&both));
    let each = after / equations.max(1) as f64;
    (before - after > SURE * each && after < LEFT * before).then_some(open)
}

/// Constants that were found in place of stated ones, a sentence a camera.
#[must_use]
pub fn found(stated: &[Instrument], found: &[Instrument]) -> Vec<String> {
    let known = |own: &&Instrument| {
        let same = |i: &&Instrument| i.form == own.form && i.label == own.label;
        stated.iter().find(same).is_some_and(|i| !i.free[NUMBERS..].contains(&true))
    };
    let cameras = found.iter().filter(|own| own.form == Form::Camera);
    let freed = cameras.filter(|own| own.free[NUMBERS..].contains(&true));
    let sentence = |own: &Instrument| {
        format!(
            "camera \"{}\": its stated focal lengths, centre and distortion do not fit the images; \
             they were found with the arm, as with intrinsics = \"free\"",
            own.label
        )
    };
    freed.filter(known).map(sentence).collect()
}

/// Geometry alone.
struct Fitted<'a> {
    problem: Problem<'a>,
    fit: RobustFit,
}

fn fitted<'a>(robot: &Robot, data: &'a Measurements) -> Option<Fitted<'a>> {
    let problem = Problem::new(data, robot, Scaling::Prior);
    let start = register(data, &problem.nominal, robot.tool).ok()?;
    let mut problem = problem.about(&start);
    let rows = problem.counted();
    problem.noise = noise_estimate::noise(&problem, &rows, &start).ok()?;
    let fit = robust_fit(&problem, &rows, &start, Flags::default()).ok()?;
    Some(Fitted { problem, fit })
}

impl Fitted<'_> {
    /// Squares of what is left of some rows, in stated sigmas.
    fn left(&self, rows: &[usize]) -> f64 {
        let at = self.problem.linearise(&self.fit.fit.state);
        let square = |row: &usize| {
            let own = &self.problem.data.rows[*row];
            let sigmas = kind(own).sigmas(own);
            at.residual(*row).values().zip_map(&sigmas, |r, s| r / s).norm_squared()
        };
        rows.iter().map(square).sum()
    }
}
