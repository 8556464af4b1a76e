//! Remarks on noise that is not the same every way, or has tails.

use super::crowd::crowded;
use super::node::Node;
use super::policy::POLICY;
use super::rounding;
use super::weigh::Weighed;
use crate::error::count;
use crate::identify::{Place, Problem, Scatterer};
use crate::observations::kind;
use crate::statistics::median;
use crate::units::{joint_micro, to_mm};

/// Of what scatters by itself.
pub fn all<'a>(problem: &'a Problem, weighed: &'a Weighed) -> impl Iterator<Item = String> + 'a {
    let sight = |source: &(Scatterer, f64)| sight(problem, *source);
    joints(weighed)
        .map(|joint| scattering(problem, joint))
        .chain(weighed.scattering.iter().filter_map(sight))
}

/// Joints that scatter, counted from 0, and by how much, rad or m.
pub fn joints(weighed: &Weighed) -> impl Iterator<Item = (usize, f64)> + '_ {
    weighed.scattering.iter().filter_map(|(source, size)| Some((source.joint()?, *size)))
}

/// What a joint scatters by itself.
pub fn scatters(problem: &Problem, (joint, size): (usize, f64)) -> String {
    let unit = joint_micro(problem.nominal[joint].kind);
    let by = format!(
        "joint {} scatters by {:.0} {unit} (one standard deviation) beyond the noise of the \
         measurement",
        joint + 1,
        size * 1e6
    );
    match rounding::explains(problem, joint, size) {
        Some(rounded) => format!("{by}: {rounded}"),
        None => format!("{by}, by nothing that a column says"),
    }
}

/// A remark on such a joint.
fn scattering(problem: &Problem, (joint, size): (usize, f64)) -> String {
    let remedy = match rounding::explains(problem, joint, size) {
        Some(_) => "write more digits",
        None => "look at its brake, servo and encoder",
    };
    let path = problem.data.path.display();
    format!("{path}: {}: {remedy}", scatters(problem, (joint, size)))
}

/// A remark on an instrument whose line of sight scatters.
fn sight(problem: &Problem, (source, size): (Scatterer, f64)) -> Option<String> {
    let data = problem.data;
    let from = source.instrument()?;
    let at = from.point();
    let distance = |row| Some((kind(row).point(row)? - at).norm());
    let range = median(&data.rows.iter().filter_map(distance).collect::<Vec<f64>>());
    let scatter = to_mm(size * range);
    let along = matches!(source, Scatterer::Range(_));
    let (way, share, reads) = match along {
        true => ("along", format!("{:.0} um/m", size * 1e6), "distances"),
        false => ("across", format!("{:.0} urad", size * 1e6), "angles"),
    };
    // Of a place that was looked for the direction is told far better than how far off it is: of
    // 36 whose truth somebody else knew it was wrong by more than half in 12, and so were angles.
    let scattered = match from {
        Place::ORIGIN => format!(
            "points scatter by {scatter:.3} mm (one standard deviation, at {range:.1} m from the \
             origin of their coordinates) beyond the noise {other} the line from there, {way} it and \
             in proportion to the distance, {share}, as where an instrument there reads {reads}",
            other = if along { "across" } else { "along" },
        ),
        _ => format!(
            "points scatter by {scatter:.3} mm (one standard deviation) beyond the noise {other} the \
             line from about x {:.1}, y {:.1}, z {:.1} m of their coordinates, {way} it and the \
             more the farther off, as where an instrument there reads {reads} (how far off it \
             stands is hardly told)",
            at.x,
            at.y,
            at.z,
            other = if along { "across" } else { "along" },
        ),
    };
    Some(format!(
        "{}: {scattered}: it is counted as noise of the measurement, and what is near tells more",
        data.path.display(),
    ))
}

/// A remark on rows that stand out as the ends of tails do.
pub fn tails(problem: &Problem, best: &Node, gross: f64) -> Option<String> {
    let rows = best.fit.outliers.len();
    (rows > 0 && gross < POLICY.suspected && !crowded(problem, best)).then(|| {
        format!(
            "{}: {rows} left out for standing out by no more than tails of this noise do: nothing \
             says that any is wrong",
            problem.data.path.display(),
            rows = count(rows, "row"),
        )
    })
}
