//! Columns of parts against differences, and what covariates make of odd files.

use std::f64::consts::TAU;

use nalgebra::{Rotation3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_simulate::robots::ALL;

use super::*;
use crate::diagnose::weigh::nameless::without;
use crate::identify::{Scaling, State};
use crate::model::{Form, Measurements, Robot};
use crate::observations::equations_of;
use crate::observations::tests::{cell, read, start};

fn arm() -> Robot {
    Robot::parse("robot.toml".as_ref(), ALL[0]).unwrap()
}

fn rows_of(kinds: &[(&'static str, usize)], robot: &Robot) -> Measurements {
    let cell = cell(robot, &mut ChaCha8Rng::seed_from_u64(5));
    read(robot, &cell, kinds, 6)
}

/// The state with everything turned about the origin of what measures, and shifted.
fn carried(state: &State, turn: Vector3<f64>, shift: Vector3<f64>) -> State {
    let mut out = state.clone();
    let turn = Rotation3::from_scaled_axis(turn);
    for base in &mut out.bases {
        base.rotation = turn.matrix() * base.rotation;
        base.translation = turn * base.translation + shift;
    }
    out
}

/// Of points, and of poses, which an instrument that errs turns as well.
#[test]
fn an_instrument_errs_as_if_all_before_it_moved() {
    let robot = arm();
    let data = rows_of(&[("point", 12), ("pose", 12)], &robot);
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let state = start(&problem, &robot);
    let at = problem.linearise(&state);
    let step = 1e-5;
    for row in 0..data.rows.len() {
        let target = at.target(row).0;
        let ray = target.normalize();
        let across = Vector3::z().cross(&ray).normalize();
        let still = Vector3::zeros();
        for (part, turn, shift) in [
            (Part::Azimuth, Vector3::z(), still),
            // Up is about what lies to the right of the ray.
            (Part::Elevation, -across, still),
            (Part::Distance, still, ray),
        ] {
            let e = at.equations_beside(row, &|i, d| part.moves(&problem, i, d));
            let column = e.block.column(e.block.ncols() - 1);
            let moved = |by: f64| {
                problem.linearise(&carried(&state, turn * by, shift * by)).scaled_residual(row)
            };
            let slope = (moved(-step) - moved(step)) / (2.0 * step);
            for c in 0..slope.len() {
                let off = (slope[c] - column[c]).abs();
                assert!(off < 1e-5 * column.amax(), "{part:?} row {row}: {slope:?} {column}");
            }
        }
    }
}

/// A target that gets farther by a metre from what it touches, or from an anchor, is measured a
/// metre off; rows that have nothing to do with it stay.
#[test]
fn surfaces_and_lengths_move_what_is_measured_against_them() {
    let robot = arm();
    let data = rows_of(&[("distance", 150), ("touch", 150)], &robot);
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let state = start(&problem, &robot);
    let problem = problem.about(&state);
    let at = problem.linearise(&state);
    let own = |part: &Part| matches!(part, Part::Surface(_) | Part::Length(_));
    let parts: Vec<Part> = Part::all(&problem, false).filter(own).collect();
    let of = |part: Part| {
        let column = |row: usize| {
            let e = at.equations_beside(row, &|i, d| part.moves(&problem, i, d));
            e.block[(0, e.block.ncols() - 1)] * e.scale[0]
        };
        (0..data.rows.len()).map(column).collect::<Vec<f64>>()
    };
    let measures = |part: Part, row: usize| match part {
        Part::Surface(k) => problem.cell.surface(&data, row) == Some(k),
        Part::Length(Some(k)) => problem.cell.anchor(&data, row) == Some(k),
        _ => problem.cell.anchor(&data, row).is_some(),
    };
    assert!(parts.iter().any(|p| matches!(p, Part::Surface(_))), "{parts:?}");
    assert!(parts.iter().any(|p| matches!(p, Part::Length(_))), "{parts:?}");
    for part in parts {
        for (row, moved) in of(part).into_iter().enumerate() {
            let right = if measures(part, row) { 1.0 } else { 0.0 };
            assert!((moved - right).abs() < 1e-6, "{part:?} row {row}: {moved}");
        }
    }
}

/// A plane has two axes of three, whatever way the arm stands.
#[test]
fn a_plane_is_off_as_places_on_it_go() {
    let robot = arm();
    let data = rows_of(&[("touch", 24)], &robot);
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let mut state = start(&problem, &robot);
    let plane = state.instruments.iter().position(|i| i.form == Form::Plane).unwrap();
    state.bases[0].rotation = *Rotation3::from_euler_angles(0.3, -1.1, 2.0).matrix();
    // A tilt of one that is found is where it stands; of one that is known it is an error.
    let mut known = data.clone();
    known.instruments[plane].free.fill(false);
    for (data, found) in [(&data, true), (&known, false)] {
        let problem = Problem::new(data, &robot, Scaling::Prior);
        assert_eq!(Part::Surface(plane).has_slope(&problem), found);
        let problem = problem.about(&state);
        let axis = (0..3).find(|axis| problem.cell.lies_on(plane, *axis)).unwrap();
        let (part, with) = (Part::Surface(plane), Covariate::Place(axis));
        assert_eq!(has_name(&problem, part, with, Shape::Bow(1)), found);
        assert!(!has_name(&problem, part, with, Shape::Bow(3)));
    }
    for (way, normal) in [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().enumerate() {
        let turn = Rotation3::rotation_between(&Vector3::z(), &normal).unwrap();
        state.instruments[plane].place.rotation = state.bases[0].rotation * turn.matrix();
        let about = problem.clone().about(&state);
        let on: Vec<usize> = (0..3).filter(|axis| about.cell.lies_on(plane, *axis)).collect();
        assert_eq!(on, (0..3).filter(|axis| *axis != way).collect::<Vec<_>>());
    }
}

/// The first row of a pair has no equations, and the second is off by what both ends are.
#[test]
fn what_has_no_name_is_set_aside_in_every_kind() {
    let robot = arm();
    let kinds = ["point", "pose", "distance", "pair", "plate", "touch", "range", "inclination"];
    for kind in kinds.into_iter().chain(["closure", "pixel"]) {
        let data = rows_of(&[(kind, if kind == "pixel" { 2 } else { 8 })], &robot);
        let problem = Problem::new(&data, &robot, Scaling::Prior);
        let state = start(&problem, &robot);
        let how = Smooth { range: [-3.0, 3.0], shape: Shape::Wave(1) };
        let hose = Follows { part: Part::Joint(3), with: Covariate::Joint(1), how };
        let by = DVector::from_vec(vec![2e-4, 1e-4]);
        let held = [(Nameless::Follows(hose), by.clone())];
        let apart = without(&problem, &state, &held);
        let (at, apart) = (problem.linearise(&state), apart.linearise(&state));
        for row in (0..data.rows.len()).filter(|row| equations_of(&data.rows[*row]) > 0) {
            let e = at.equations_beside(row, &|i, d| hose.columns(&problem, i, d));
            let two = e.block.columns(e.block.ncols() - 2, 2) * &by;
            let less = at.scaled_residual(row) - apart.scaled_residual(row);
            for c in 0..less.len() {
                assert!((less[c] - two[c]).abs() < 1e-9 * (1.0 + two.amax()), "{kind} {row}");
            }
        }
    }
}

/// A sector on the far side of the instrument is as wide as one on the near side.
#[test]
fn what_comes_round_begins_behind_its_widest_gap() {
    let mut values: Vec<f64> = (0..100).map(|k| 2.9 + 0.005 * f64::from(k)).collect();
    values.iter_mut().for_each(|v| *v = if *v > TAU / 2.0 { *v - TAU } else { *v });
    let [low, high] = smooth::range(&mut values, true).unwrap();
    assert!((high - low - 0.495).abs() < 1e-9, "{low} {high}");
    assert!((low.rem_euclid(TAU) - 2.9).abs() < 1e-9);
}

/// One time of another day is no measure for the others.
#[test]
fn a_value_far_out_does_not_stretch_the_range() {
    let mut values: Vec<f64> = (0..200).map(f64::from).collect();
    assert_eq!(smooth::range(&mut values, false), Some([0.0, 199.0]));
    values.push(3e6);
    let [low, high] = smooth::range(&mut values, false).unwrap();
    assert!(low == 0.0 && high < 300.0, "{low} {high}");
    assert_eq!(smooth::range(&mut [1.0; 9], false), None);
    assert_eq!(smooth::range(&mut [], true), None);
}

/// What a dense projection says.
#[test]
fn explained_is_what_a_dense_fit_explains() {
    let (n, p, c) = (60, 4, 3);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut draw = |r, k| DMatrix::from_fn(r, k, |_, _| truearm_simulate::normal(&mut rng));
    let (geometry, ways, functions, left) = (draw(n, p), draw(n, 1), draw(n, c), draw(n, 1));
    let columns = DMatrix::from_fn(n, c, |i, j| ways[i] * functions[(i, j)]);
    // What geometry leaves of the residual, as a scan is given it.
    let factor = (geometry.tr_mul(&geometry)).cholesky().unwrap();
    let left = &left - &geometry * factor.solve(&geometry.tr_mul(&left));
    let way = JointColumn {
        q: Vec::new(),
        square: ways.iter().map(|w| w * w).collect(),
        right: ways.iter().zip(left.iter()).map(|(w, l)| w * l).collect(),
        imitated: factor
            .l()
            .solve_lower_triangular(&DMatrix::from_fn(p, n, |i, j| geometry[(j, i)] * ways[j]))
            .unwrap(),
    };
    let projected = &columns - &geometry * factor.solve(&geometry.tr_mul(&columns));
    let b = projected.tr_mul(&left);
    let exact = b.dot(&projected.tr_mul(&projected).cholesky().unwrap().solve(&b));
    let own = explained(&way, &functions, 1.0);
    assert!((own / exact - 1.0).abs() < 1e-3, "{own} {exact}");
}
