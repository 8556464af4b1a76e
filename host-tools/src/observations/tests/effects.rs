//! What effects do to every kind, against differences of its residual: where the target
//! is and how it is turned, at either end of a pair, of a camera in hand and of one that
//! stands still.

use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::Pose;
use truearm::effects::{ActsOn, Effect, Order, Term};
use truearm_simulate::robots::ALL;

use super::super::measuring;
use super::{cell, read, start};
use crate::identify::{Problem, Scaling, State};
use crate::model::{Clock, Form, Measurements, ModelTerm, Robot};

/// Six and seven joints, with weight.
fn arms() -> [Robot; 2] {
    [ALL[0], ALL[4]].map(|text| {
        let text = format!("gravity_m_s2 = [0.0, 0.0, -9.81]\n{text}");
        Robot::parse("robot.toml".as_ref(), &text).unwrap()
    })
}

/// All that effects go with, at random.
fn surrounded(data: &mut Measurements, rng: &mut ChaCha8Rng) {
    for row in &mut data.rows {
        row.directions = row.q.iter().map(|_| if rng.random_bool(0.5) { 1 } else { -1 }).collect();
        row.temperature = Some(rng.random_range(15.0..35.0));
        row.payload = Some(rng.random_range(0.0..5.0));
        row.time = Some(rng.random_range(0.0..7200.0));
        row.order = Some(rng.random_range(0.0..100.0));
        row.series = Some(["a", "b"][usize::from(rng.random_bool(0.5))].to_owned());
    }
}

/// A term of every component of every effect somewhere, and those of the measurement;
/// coefficients are 0.
fn terms(joints: u8, rng: &mut ChaCha8Rng) -> Vec<ModelTerm> {
    let mut out = Vec::new();
    for effect in Effect::ALL.iter().copied() {
        for component in 0..effect.components().len().max(1) {
            let joint = match effect.acts_on() {
                ActsOn::Base => 0,
                // Some links have no length.
                ActsOn::Lengths => Term::<f64>::ALL,
                _ => rng.random_range(1..joints),
            };
            let order = if matches!(effect.order(), Order::Harmonic) { 1.0 } else { 0.0 };
            let order = if matches!(effect.order(), Order::Cycles) { 7.0 } else { order };
            let source = if effect.is_coupled() { joint - 1 } else { 0 };
            let component = component as u8;
            let term = Term { effect, joint, source, component, order, coefficient: 0.0 };
            out.push(ModelTerm::Arm(term));
        }
    }
    let course = Clock::Time.settles(0.5);
    let drift = |component| ModelTerm::Drift { component, course, coefficient: 0.0 };
    out.extend((0..6).map(drift));
    let remount = |axis| ModelTerm::Remount { series: "b".to_owned(), axis, coefficient: 0.0 };
    out.extend((0..3).map(remount));
    out.push(ModelTerm::Lag { joint: 2, coefficient: 0.0 });
    out
}

/// The camera stands still and sees the board on the flange, or the marker itself.
fn eye_to_hand(data: &mut Measurements, state: &mut State, marker: bool) {
    let axes = [Vector3::y(), -Vector3::z(), -Vector3::x()];
    let at = Pose { rotation: Matrix3::from_columns(&axes), translation: Vector3::x() * 3.0 };
    for instrument in &mut state.instruments {
        match instrument.form {
            Form::Camera => (instrument.on_flange, instrument.place) = (false, at),
            _ => instrument.on_flange = true,
        }
    }
    if marker {
        data.rows.iter_mut().for_each(|row| {
            row.refers.truncate(1);
            row.measured = row.measured.iter().copied().take(2).collect();
        });
    }
}

/// The worst column of a file beside the differences of its rows, over its largest entry,
/// and whether every effect was seen to do something.
fn worst(data: &Measurements, robot: &Robot, state: &State) -> (f64, Vec<String>) {
    let problem = Problem::new(data, robot, Scaling::Prior).with_terms(state.terms.len());
    let at = problem.linearise(state);
    let first = problem.unknowns.terms().start;
    let rows = measuring(&data.rows);
    // Beside what a mm or a mrad of a link does, per m or rad.
    let steepest =
        rows.iter().map(|row| at.equations(*row).block.amax()).fold(0.0, f64::max) / 1e-3;
    let (mut worst, mut still) = (0.0_f64, Vec::new());
    for k in 0..state.terms.len() {
        let unit = problem.unit(problem.unknowns.list()[first + k]);
        let loads = problem.conditions.rows.iter().zip(&data.rows);
        let basis =
            |(inputs, row): (&crate::model::arm::RowInputs, &crate::model::Row)| match &state.terms
                [k]
            {
                ModelTerm::Arm(term) => inputs.basis(&row.q, term).abs(),
                _ => 1.0,
            };
        // Some 10 um and urad.
        let size = 1e-5 / loads.map(basis).fold(1e-9, f64::max);
        let moved = |size: f64| {
            let mut moved = state.clone();
            *moved.terms[k].coefficient_mut() = size;
            problem.linearise(&moved)
        };
        let (less, more) = (moved(-size), moved(size));
        let (mut largest, mut off) = (0.0_f64, 0.0_f64);
        for row in rows.iter().copied() {
            let block = at.equations(row).block;
            let slope = (less.scaled_residual(row) - more.scaled_residual(row)) / (2.0 * size);
            for c in 0..slope.len() {
                let column = block[(c, first + k)] / unit;
                largest = largest.max(column.abs()).max(slope[c].abs());
                off = off.max((slope[c] - column).abs());
            }
        }
        // What does nothing leaves the rounding of differences.
        if largest < 1e-8 * steepest {
            still.push(format!("{} {}", state.terms[k].effect_name(), state.terms[k].part()));
        } else {
            worst = worst.max(off / largest);
        }
    }
    (worst, still)
}

#[test]
fn columns_of_every_effect_in_every_kind() {
    let kinds = ["point", "pose", "distance", "pair", "plate", "touch", "sphere", "cylinder"];
    let more = ["range", "inclination", "closure", "pixel", "to hand", "marker"];
    for (seed, robot) in arms().iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(20 + seed as u64);
        let cell = cell(robot, &mut rng);
        for kind in kinds.into_iter().chain(more) {
            let (wanted, count) = match kind {
                "pixel" | "to hand" | "marker" => ("pixel", 2),
                _ => (kind, 8),
            };
            let mut data = read(robot, &cell, &[(wanted, count)], 7);
            surrounded(&mut data, &mut rng);
            let mut state = start(&Problem::new(&data, robot, Scaling::Prior), robot);
            state.terms = terms(robot.joints.len() as u8, &mut rng);
            if wanted != kind && wanted == "pixel" {
                eye_to_hand(&mut data, &mut state, kind == "marker");
            }
            let (worst, still) = worst(&data, robot, &state);
            println!("{kind}: {worst:.1e}; {still:?}");
            assert!(worst < 1e-6, "{kind}: {worst:e}");
            // Lengths do not turn a level, nor does a turn about the vertical; a camera in
            // hand does not see the marker.
            let level = ["thermal-expansion ", "measurement-drift rz"];
            let nothing = |what: &str| match kind {
                "inclination" => {
                    what.starts_with("tool-remount")
                        || level.contains(&what)
                        || ["x", "y", "z"].iter().any(|c| what == format!("measurement-drift {c}"))
                }
                "pixel" | "to hand" => what.starts_with("tool-remount"),
                _ => false,
            };
            let lost: Vec<&String> = still.iter().filter(|what| !nothing(what)).collect();
            assert!(lost.is_empty(), "{kind}: {lost:?}");
        }
    }
}

/// Beside a drift and a lag that are there the columns stay good to what these turn.
#[test]
fn columns_beside_what_already_moves() {
    let [robot, _] = arms();
    let mut rng = ChaCha8Rng::seed_from_u64(30);
    let cell = cell(&robot, &mut rng);
    for kind in ["pose", "inclination", "range"] {
        let mut data = read(&robot, &cell, &[(kind, 8)], 8);
        surrounded(&mut data, &mut rng);
        let problem = Problem::new(&data, &robot, Scaling::Prior).with_terms(4);
        let mut state = start(&problem, &robot);
        let drift = |component, coefficient| ModelTerm::Drift {
            component,
            course: Clock::Time.goes_on(),
            coefficient,
        };
        let lag = ModelTerm::Lag { joint: 3, coefficient: 4e-4 };
        state.terms = vec![drift(0, 2e-4), drift(1, -1e-4), drift(5, 1e-4), lag];
        let at = problem.linearise(&state);
        let first = problem.unknowns.terms().start;
        for k in 0..4 {
            let mut moved = state.clone();
            *moved.terms[k].coefficient_mut() += 1e-6;
            let moved = problem.linearise(&moved);
            let unit = problem.unit(problem.unknowns.list()[first + k]);
            let (mut largest, mut off) = (0.0_f64, 0.0_f64);
            for row in measuring(&data.rows) {
                let slope = (at.scaled_residual(row) - moved.scaled_residual(row)) / 1e-6;
                let block = at.equations(row).block;
                for c in 0..slope.len() {
                    largest = largest.max(slope[c].abs());
                    off = off.max((slope[c] - block[(c, first + k)] / unit).abs());
                }
            }
            println!("{kind}, term {k}: {:.1e}", off / largest);
            assert!(off <= 2e-3 * largest, "{kind}, term {k}: {:e}", off / largest);
        }
    }
}
