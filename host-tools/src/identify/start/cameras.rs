//! Constants of a camera that are not those it was stated with: a lens that was calibrated at
//! another focus, in other units of distortion. As known numbers they bend the arm, and look
//! like an effect of it.

use super::alone::Alone;
use crate::identify::problem::{Noise, in_deviations};
use crate::model::{Form, Instrument, Measurements, Robot, Row};
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
/// not seem to fit: effects of the arm may look like it. `None` where they do, or nothing can be
/// said.
#[must_use]
pub fn freed(robot: &Robot, data: &Measurements) -> Option<Measurements> {
    let seen = |camera: &usize| {
        let own = |row: &&Row| kind(row).is_image() && row.refers[0] == *camera;
        data.rows.iter().filter(own).count()
    };
    let stated =
        |k: &usize| data.instruments[*k].form == Form::Camera && !is_free(&data.instruments[*k]);
    let cameras: Vec<usize> =
        (0..data.instruments.len()).filter(|k| stated(k) && seen(k) >= ENOUGH).collect();
    if cameras.is_empty() {
        return None;
    }
    let mut open = data.clone();
    cameras.iter().for_each(|k| open.instruments[*k].free[NUMBERS..].fill(true));
    let [stated, found] = [data, &open].map(|data| Alone::of(robot, data));
    let (stated, found) = stated.zip(found)?;
    // Of rows that neither has left out.
    let mut both = stated.fit.kept.clone();
    let lost = |row: &usize| found.fit.outliers.iter().any(|o| o.row == *row);
    both.retain(|row| !lost(row));
    let [before, after] = [&stated, &found].map(|fit| left(fit, &both));
    let each = after / stated.problem.equations(&both).max(1) as f64;
    (before - after > SURE * each && after < LEFT * before).then_some(open)
}

/// Constants that were found in place of stated ones, a sentence a camera.
#[must_use]
pub fn found(stated: &[Instrument], found: &[Instrument]) -> Vec<String> {
    let known = |own: &&Instrument| {
        let same = |i: &&Instrument| i.form == own.form && i.label == own.label;
        stated.iter().find(same).is_some_and(|i| !is_free(i))
    };
    let freed = found.iter().filter(|own| own.form == Form::Camera && is_free(own));
    let sentence = |own: &Instrument| {
        format!(
            "camera \"{}\": its stated focal lengths, centre and distortion do not fit the images; \
             they were found with the arm, as with intrinsics = \"free\"",
            own.label
        )
    };
    freed.filter(known).map(sentence).collect()
}

/// Whether constants of a camera are unknown.
fn is_free(camera: &Instrument) -> bool {
    camera.free[NUMBERS..].contains(&true)
}

/// Squares of what a fit leaves of some rows, in stated deviations.
fn left(of: &Alone, rows: &[usize]) -> f64 {
    let (at, stated) = (of.problem.linearise(&of.fit.fit.state), Noise::default());
    let off = |row: &usize| in_deviations(&at.residual(*row), &of.problem.data.rows[*row], &stated);
    rows.iter().map(|row| off(row).norm_squared()).sum()
}
