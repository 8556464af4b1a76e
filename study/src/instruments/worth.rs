//! How the tool error falls with the number of measurements of each kind.

use rayon::prelude::*;
use truearm_host::model::Robot;
use truearm_host::plot::{Axis, Mark, Panel, Rule, Series};

use super::cases::{CASES, GOAL, OF_THEIR_OWN, Wanted};
use crate::judged::once;

/// Octaves about the number of a case.
const OCTAVES: std::ops::RangeInclusive<i32> = -3..=2;

/// The panel of an arm: by the bound of so many arms, a curve a kind.
#[must_use]
pub fn panel(name: &str, robot: &Robot, arms: u64) -> Panel {
    let curve = |(what, wanted): (&str, &Wanted)| {
        let points: Vec<_> = OCTAVES.filter_map(|k| point(robot, wanted, k, arms)).collect();
        let note = |p: &(f64, f64)| format!("{}: {:.3} mm", p.0, p.1);
        let notes = points.iter().map(note).collect();
        Series::new(without_number(what), points, Mark::Line).notes(notes)
    };
    let series = CASES.map(curve).to_vec();
    let [x, y] = ["measurements", "tool error, RMS, mm"].map(Axis::log);
    let goal = Rule { at: GOAL * 1e3, name: "0.1 mm".to_owned() };
    let title = format!("{name}: what so many measurements of a kind are worth");
    Panel { rules: vec![goal], size: (760.0, 520.0), ..Panel::new(title, x, y, series) }
}

/// How many, and the bound in mm; none where some arm cannot be determined by them.
fn point(robot: &Robot, wanted: &Wanted, octave: i32, arms: u64) -> Option<(f64, f64)> {
    let (kind, count) = wanted[0];
    let count = (count as f64 * 2_f64.powi(octave)).round() as usize;
    let bound = |seed| once(robot, &[(kind, count)], OF_THEIR_OWN + seed).map(|x| x[1]);
    let bounds: Result<Vec<f64>, _> = (0..arms).into_par_iter().map(bound).collect();
    let mean = bounds.ok()?.iter().sum::<f64>() / arms as f64;
    Some((count as f64, mean.sqrt() * 1e3))
}

/// A case's words without how many it has.
fn without_number(what: &str) -> &str {
    what.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::robot;
    use truearm_simulate::robots;

    #[test]
    fn more_of_a_kind_leave_a_smaller_error() {
        let robot = robot(robots::UR10_LIKE);
        let at = |octave| point(&robot, CASES[0].1, octave, 2).unwrap();
        let (few, many) = (at(-1), at(1));
        assert_eq!([few.0, many.0], [25.0, 100.0]);
        assert!(many.1 < 0.8 * few.1 && many.1 > 0.25 * few.1, "{few:?} {many:?}");
    }
}
