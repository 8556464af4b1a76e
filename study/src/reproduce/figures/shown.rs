//! Figures of the one cell that is shown.

use nalgebra::Vector3;

use super::super::example::Example;
use super::super::section_v::NinePoses;
use truearm_host::methods::{Comparison, Outcome, ink};
use truearm_host::observations::Miss;
use truearm_host::plot::{Axis, Panel, Series, grid, numbered};

/// Methods of the paper's figures, both forms of its own.
const DRAWN: [&str; 6] = ["NC", "LSM", "GD", "GN", "RPIM-P", "RPIM"];

/// Points seen from above and from the side, mm.
fn projections(title: &str, sets: &[(&str, Vec<Vector3<f64>>)]) -> String {
    let panel = |name: &str, k: usize| {
        let axis = ["x", "y", "z"][k];
        let series = |(name, points): &(&str, Vec<Vector3<f64>>)| {
            Series::points(*name, points.iter().map(|p| (p.x * 1e3, p[k] * 1e3)).collect())
        };
        Panel {
            title: format!("{title}, {name}"),
            x: Axis::linear("x, mm"),
            y: Axis::signed(format!("{axis}, mm")),
            series: sets.iter().map(series).collect(),
            equal: true,
            ..Panel::default()
        }
    };
    grid(&[panel("from above", 1), panel("from the side", 2)], 2)
}

pub fn frames(e: &Example) -> String {
    let measured = e.cell.identification.rows.iter().map(|r| r.measured.point()).collect();
    projections("Each in its own frame", &[("reference", e.reference()), ("measured", measured)])
}

/// From the tracker's frame to the robot's.
fn in_robot_frame(e: &Example, points: impl Iterator<Item = Vector3<f64>>) -> Vec<Vector3<f64>> {
    let base = e.start.bases[0].inverse();
    points.map(|p| base.transform_point(&p)).collect()
}

/// Differences of a millimetre cannot be seen in a metre.
const DRAWN_LARGER: f64 = 25.0;

fn larger(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    from.iter().zip(to).map(|(a, b)| a + (b - a) * DRAWN_LARGER).collect()
}

pub fn registered(e: &Example) -> String {
    let reference = e.reference();
    let measured = in_robot_frame(e, e.cell.identification.rows.iter().map(|r| r.measured.point()));
    let measured = larger(&reference, &measured);
    let title = format!("One frame (Eq. 17), differences drawn {DRAWN_LARGER} times");
    projections(&title, &[("reference", reference), ("measured", measured)])
}

fn distances(residuals: &[impl Miss]) -> Vec<f64> {
    residuals.iter().map(|r| r.miss() * 1e3).collect()
}

fn method<'a>(found: &'a Comparison, name: &str) -> Option<&'a Outcome> {
    found.methods.iter().find(|o| o.name == name && o.state.is_some())
}

pub fn before(e: &Example) -> String {
    let errors = method(&e.held, "NC").map(|o| distances(&o.residuals)).unwrap_or_default();
    Panel {
        title: "Error of each pose after registration, no calibration".to_owned(),
        x: Axis::linear("pose"),
        y: Axis::linear("position error, mm"),
        series: vec![Series::bars("", &errors)],
        ..Panel::default()
    }
    .svg()
}

pub fn l_curve(e: &Example) -> String {
    let place = |p: &[f64; 3]| (p[1] * 1e3, p[2]);
    Panel {
        title: "L-curve, lambda I on metres and radians (Eq. 15)".to_owned(),
        x: Axis::log("norm of the residual, mm"),
        y: Axis::log("norm of the solution, m and rad"),
        series: vec![
            Series::line("", e.curve.points.iter().map(place).collect()),
            Series::points(
                format!("corner {:.1e}", e.curve.corner[0]),
                vec![place(&e.curve.corner)],
            ),
            Series::points(
                format!("two-step {:.1e}", e.curve.chosen[0]),
                vec![place(&e.curve.chosen)],
            ),
        ],
        ..Panel::default()
    }
    .svg()
}

pub fn simulated(e: &Example) -> String {
    let plane = |points: Vec<Vector3<f64>>| points.iter().map(|p| (p.x * 1e3, p.z * 1e3)).collect();
    let mut series = vec![Series::points(
        "measured",
        plane(in_robot_frame(e, e.cell.identification.rows.iter().map(|r| r.measured.point()))),
    )];
    let cases = &e.curve.simulated;
    for (k, points) in cases.iter().enumerate().step_by(3) {
        let name = format!("case {}", k + 1);
        series.push(Series::points(name, plane(in_robot_frame(e, points.iter().copied()))));
    }
    let apart = |points: &Vec<Vector3<f64>>| {
        let pairs = points.iter().zip(&cases[5]);
        pairs.map(|(a, b)| (a - b).norm() * 1e6).fold(0.0, f64::max)
    };
    let moved: Vec<f64> = cases.iter().map(apart).collect();
    let points = Panel {
        title: "52 points simulated with four of ten lambdas".to_owned(),
        x: Axis::linear("x, mm"),
        y: Axis::signed("z, mm"),
        series,
        ..Panel::default()
    };
    let moved = Panel {
        title: "The same: how far the points of a case are from case 6".to_owned(),
        x: Axis::linear("case"),
        y: Axis::linear("largest distance, um"),
        series: vec![Series::bars("", &moved)],
        ..Panel::default()
    };
    grid(&[points, moved], 2)
}

pub fn against_lambda(e: &Example) -> String {
    let wide = |k: usize| e.curve.errors.iter().map(|p| (p[0], p[k])).collect::<Vec<_>>();
    let over = Panel {
        title: "Mean error against lambda".to_owned(),
        x: Axis::log("lambda, m^2"),
        y: Axis::log("mean position error, mm"),
        series: vec![
            Series::line("52 fitted", wide(1)),
            Series::line("250 noise-free", wide(2)),
            Series::points("first step", e.curve.decades.clone()),
            Series::points("second step", e.curve.tenths.clone()),
        ],
        ..Panel::default()
    };
    let least = e.curve.tenths.iter().map(|t| t.1).fold(f64::INFINITY, f64::min);
    let tenths = e.curve.tenths.iter().map(|t| (t.0, (t.1 - least) * 1e6)).collect();
    let second = Panel {
        title: "Second step: mean error above the least of the ten".to_owned(),
        x: Axis::linear("lambda, m^2"),
        y: Axis::linear("nm"),
        series: vec![Series::points("", tenths)],
        ..Panel::default()
    };
    grid(&[over, second], 2)
}

pub fn per_point(e: &Example) -> String {
    let series = e
        .curve
        .by_point
        .iter()
        .map(|(lambda, errors)| Series::points(format!("{lambda:.1e}"), numbered(errors)));
    Panel {
        title: "Error of each of the 52 points for five lambdas".to_owned(),
        x: Axis::linear("pose"),
        y: Axis::linear("position error, mm"),
        series: series.collect(),
        ..Panel::default()
    }
    .svg()
}

pub fn methods(found: &Comparison, validation: bool) -> String {
    let dots = |o: &Outcome| {
        let rows = if validation { &o.validation_residuals } else { &o.residuals };
        Series::points(o.name, numbered(&distances(rows))).ink(ink(o.name))
    };
    let rows = if validation { "18 validation" } else { "52 fitted" };
    Panel {
        title: format!("Error of the {rows} points, base and tool held"),
        x: Axis::linear("pose"),
        y: Axis::log("position error, mm"),
        series: DRAWN.iter().filter_map(|name| method(found, name)).map(dots).collect(),
        ..Panel::default()
    }
    .svg()
}

pub fn validation(e: &Example) -> String {
    let rows = &e.cell.validation.rows;
    let measured = in_robot_frame(e, rows.iter().map(|r| r.measured.point()));
    let residuals = method(&e.held, "RPIM-P").map(|o| o.validation_residuals.clone());
    let residuals = residuals.unwrap_or_default();
    let simulated = rows.iter().zip(&residuals).map(|(row, r)| row.measured.point() - r.point());
    let simulated = larger(&measured, &in_robot_frame(e, simulated));
    let title = format!("18 validation points, differences drawn {DRAWN_LARGER} times");
    projections(&title, &[("measured", measured), ("RPIM-P", simulated)])
}

pub fn axes(e: &Example) -> String {
    let residuals = method(&e.held, "RPIM-P").map(|o| o.validation_residuals.clone());
    let base = e.start.bases[0].rotation;
    let turned: Vec<Vector3<f64>> =
        residuals.unwrap_or_default().iter().map(|r| base.transpose() * r.point() * 1e3).collect();
    let bars = |k: usize| {
        let values: Vec<f64> = turned.iter().map(|r| r[k]).collect();
        Series::bars(["x", "y", "z"][k], &values)
    };
    Panel {
        title: "Errors along the robot's axes after RPIM as printed, 18 points".to_owned(),
        x: Axis::linear("pose"),
        y: Axis::signed("measured minus simulated, mm"),
        series: (0..3).map(bars).collect(),
        ..Panel::default()
    }
    .svg()
}

pub fn nine_poses(nine: &NinePoses) -> String {
    let series =
        nine.methods.iter().map(|(name, _, errors, _)| Series::bars(*name, errors).ink(ink(name)));
    Panel {
        title: "Section V: error of the nine poses".to_owned(),
        x: Axis::linear("pose"),
        y: Axis::log("position error, mm"),
        series: series.collect(),
        ..Panel::default()
    }
    .svg()
}
