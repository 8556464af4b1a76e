//! What looks wrong with measurements but may be meant.

use super::blind_tool;
use super::problem::Problem;
use crate::identify::problem::{Group, groups};
use crate::identify::start::zeros;
use crate::model::{Instrument, Robot, Row};
use crate::observations::{KINDS, equations_of, kind};

/// Noise is stated within a factor of two at best, and what an arm has beyond geometry is
/// some of its sigmas more; a kind that is ten times noisier than stated measured something
/// else, or in another unit.
const FAR: f64 = 10.0;
/// The same beside a kind that is as good as stated, within [`CALM`]: the arm is then
/// described to that, and a wrong zero of a draw wire has been seen at nine.
const FAR_BESIDE: f64 = 6.0;
const CALM: f64 = 3.0;

/// A sentence each; `scale` is that of the fit's residuals over their standard deviations.
#[must_use]
pub fn of(robot: &Robot, problem: &Problem, scale: f64) -> Vec<String> {
    let data = problem.data;
    let mut warnings = [robot.warnings.clone(), data.warnings.clone()].concat();
    let again = data.rows.len() - data.distinct().len();
    if again > 0 {
        warnings.push(format!(
            "{}: {again} rows repeat others in every cell and count once",
            data.path.display()
        ));
    }
    // Corners of one image are no repeats.
    let points = data.rows.iter().filter(|row| kind(row).point(row).is_some()).count();
    if 2 * data.poses < points && data.markers.len() * data.stations.len() == 1 {
        warnings.push(format!(
            "{}: {} rows but only {} distinct poses; repeats average noise, they do not identify",
            data.path.display(),
            data.rows.len(),
            data.poses
        ));
    }
    warnings.extend(blind_tool::remarks(robot, problem));
    warnings.extend(noisy(problem, scale));
    warnings.extend(of_two_stations(problem));
    warnings.extend(of_few_rows(problem));
    let advice = "zero = \"free\" in its [[anchors]] of instruments.toml finds it with the arm";
    let doubtful = zeros::doubtful(robot, data);
    warnings.extend(doubtful.iter().map(|words| format!("{words}; {advice}")));
    warnings
}

/// Places that are found of so few rows that these say nothing of the arm: a label that was
/// mistyped is such a place.
fn of_few_rows(problem: &Problem) -> Vec<String> {
    let data = problem.data;
    let sentence = |(i, own): (usize, &Instrument)| {
        let open = problem.unknowns.instrument(i).count();
        let rows: Vec<&Row> = data.rows.iter().filter(|row| row.refers.contains(&i)).collect();
        let equations: usize = rows.iter().map(|row| equations_of(row)).sum();
        let first = rows.first().filter(|_| open > 0 && equations <= open)?;
        let count =
            if rows.len() == 1 { "1 row".to_owned() } else { format!("{} rows", rows.len()) };
        Some(format!(
            "{}: {} \"{}\" has {count}, first in line {}, which do no more than find it: give more, \
             state where it is, or check the label",
            data.path.display(),
            own.form.name(),
            own.label,
            first.line
        ))
    };
    data.instruments.iter().enumerate().filter_map(sentence).collect()
}

/// Kinds that are far noisier than stated.
fn noisy(problem: &Problem, scale: f64) -> Vec<String> {
    let (data, noise) = (problem.data, &problem.noise);
    let groups = groups(data);
    // Of one kind alone the fit scales its own.
    let alone = groups.len() < 2;
    let factor = |g: &Group| if alone { scale } else { noise.of(g.kind, g.measure) };
    let beside = groups.iter().any(|g| factor(g) < CALM);
    let limit = if beside { FAR_BESIDE } else { FAR };
    let far = groups.iter().filter(|g| factor(g) > limit);
    let sentence = |g: &Group| {
        let known = KINDS[usize::from(g.kind.0)];
        // Nothing beside it says whether the instrument is wrong or the arm.
        let arm = match alone {
            true => "the arm does what this model lacks (`truearm diagnose` looks for it), or ",
            false => "",
        };
        format!(
            "{}: rows of kind {} are {:.0} times as far off as their stated sigma ({}): {arm}check \
             {}, and the unit of the sigma",
            data.path.display(),
            known.name(),
            factor(g),
            g.measure.unit(),
            known.check()
        )
    };
    far.map(sentence).collect()
}

/// Places that rows of several stations refer to: a station has a frame of its own, and in
/// two frames one place is two.
fn of_two_stations(problem: &Problem) -> Vec<String> {
    let (data, unknowns) = (problem.data, &problem.unknowns);
    let mut out = Vec::new();
    for (i, instrument) in data.instruments.iter().enumerate().filter(|(_, i)| !i.on_flange) {
        let own = data.rows.iter().filter(|row| row.refers.contains(&i));
        let mut stations: Vec<usize> = own.map(|row| row.station).collect();
        stations.sort_unstable();
        stations.dedup();
        // Where nothing tells where the arm stands all stations are one.
        stations.retain(|station| unknowns.station(*station).is_some());
        if let [first, second, ..] = stations[..] {
            let [first, second] = [first, second].map(|s| &data.stations[s]);
            out.push(format!(
                "{}: {} \"{}\" has rows of stations \"{first}\" and \"{second}\", each a frame of \
                 its own: give them one station, or the {} two labels",
                data.path.display(),
                instrument.form.name(),
                instrument.label,
                instrument.form.name()
            ));
        }
    }
    out
}
