//! Paths compensated, over the whole joint space of arms with six and seven joints,
//! a rail and a SCARA: what is written, read again, is what was promised.

use std::path::Path as FilePath;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::Blob;
use truearm::effects::{Effect, MAX_TERMS, Term};
use truearm::{
    Approach, Arm, ArmParameters, Compensator, JointKind, MdhParameters, Pose, Settings, State,
    Task,
};
use truearm_host::blob::{PackOptions, pack_with};
use truearm_host::files::{Wanted, csv_text};
use truearm_host::model::{Model, ModelTerm, Path, Robot};
use truearm_host::paths::{
    CompensateOptions, Compensated, Forward, Inverse, REACHED_POINT, Row, View, compensate,
    compensated_csv, forward_csv, inverse_csv,
};
use truearm_host::units::{joint_column, joint_to_file};
use truearm_simulate::robots;

/// Four joints, the third slides.
const SCARA: &str = r#"
name = "SCARA, 0.65 m"
measurement_sigma_mm = 0.03
gravity_m_s2 = [0.0, 0.0, -9.81]
tool.xyz_mm = [12.0, -5.0, 60.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 400, theta_offset_deg = 0, limits_deg = [-170, 170] },
  { alpha_deg = 0, a_mm = 350, d_mm = 0, theta_offset_deg = 0, limits_deg = [-150, 150] },
  { kind = "prismatic", alpha_deg = 180, a_mm = 300, d_offset_mm = 50, theta_offset_deg = 0, limits_mm = [0, 200] },
  { alpha_deg = 0, a_mm = 0, d_mm = 20, theta_offset_deg = 0, limits_deg = [-360, 360] },
]
links = [
  { mass_kg = 8, com_mm = [0, 0, -100] },
  { mass_kg = 6, com_mm = [150, 0, 0] },
  { mass_kg = 2, com_mm = [0, 0, 0] },
  { mass_kg = 0.5, com_mm = [0, 0, 10] },
]
"#;

/// Which terms an arm has.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Terms {
    None,
    /// As many as a controller takes, one of every kind.
    Few,
    /// More periodic ones than a controller takes.
    Many,
}

/// An arm of this description, off by the sizes of real arms; its tool is turned in the
/// last frame, and its base stands in a cell.
fn model(robot: &str, terms: Terms, seed: u64) -> Model {
    let mut robot = Robot::parse(FilePath::new("robot.toml"), robot).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    robot.gravity = Some(Vector3::new(0.0, 0.0, -9.81));
    robot.tool_rpy = Vector3::new(0.3, -0.2, 1.0);
    robot.base.xyz = Vector3::new(1.0, -0.5, 0.8);
    robot.base.rpy = Vector3::new(0.1, 0.2, -0.7);
    for joint in &mut robot.joints {
        let usual = match joint.link.kind {
            JointKind::Revolute => [-3.0, 3.0],
            JointKind::Prismatic => [-0.5, 0.5],
        };
        joint.limits = joint.limits.or(Some(usual));
    }
    let mut model = Model::nominal(robot);
    for correction in &mut model.corrections {
        *correction = MdhParameters::from_array([(); 5].map(|()| rng.random_range(-5e-4..5e-4)));
    }
    let mut vector = |most: f64| Vector3::from_fn(|_, _| rng.random_range(-most..most));
    (model.frame_translation, model.frame_rotation) = (vector(1e-3), vector(1e-3));
    let tool = model.robot.tool;
    model.markers = vec![("ball".to_owned(), tool + vector(3e-3))];
    let station = Pose::from_rotation_vector(Vector3::new(2.0, 1.0, 0.3), vector(1.0));
    model.stations = vec![("T".to_owned(), station)];
    model.orientation_identified = true;
    model.covered = model.robot.joints.iter().map(|joint| joint.limits).collect();
    model.terms = some(terms, &model.robot, &mut rng).into_iter().map(ModelTerm::Arm).collect();
    model
}

fn some(terms: Terms, robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<Term<f64>> {
    let term = |effect, joint: usize, component, order: f64, coefficient| Term {
        effect,
        joint: joint as u8,
        source: 0,
        component,
        order,
        coefficient,
    };
    if terms == Terms::None {
        return Vec::new();
    }
    let mut out = vec![
        term(Effect::JointCompliance, 1, 0, 0.0, 2e-5),
        term(Effect::BaseCompliance, 0, 0, 0.0, 1e-6),
        term(Effect::Backlash, 0, 0, 0.0, 1e-4),
        term(Effect::ThermalExpansion, 255, 0, 0.0, 2e-5),
        term(Effect::JointPeriodicError, 1, 0, 20.0, 2e-4),
        term(Effect::JointPeriodicError, 1, 1, 63.0, 1e-4),
    ];
    if terms == Terms::Many {
        for (j, joint) in robot.joints.iter().enumerate() {
            for order in [1.0, 2.0, 17.0, 40.0] {
                if joint.link.kind == JointKind::Revolute {
                    let mut wave = |part| {
                        let size = rng.random_range(-2e-4..2e-4);
                        term(Effect::JointPeriodicError, j, part, order, size)
                    };
                    out.extend([wave(0), wave(1)]);
                }
            }
        }
        // Of four joints three turn: as many as a controller takes, and one more.
        assert!(out.len() > MAX_TERMS, "{}", out.len());
    }
    out
}

fn arms() -> [(&'static str, &'static str); 4] {
    [
        ("three parallel axes", robots::ALL[0]),
        ("seven joints", robots::ALL[4]),
        ("six joints on a rail", robots::ALL[5]),
        ("SCARA", SCARA),
    ]
}

fn kinds(model: &Model) -> Vec<JointKind> {
    model.robot.joints.iter().map(|joint| joint.link.kind).collect()
}

/// Commands anywhere within the limits; among them all joints at zero, joints at a
/// limit, and pairs of joints at zero, where arms are singular.
fn commands(model: &Model, count: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let joints = &model.robot.joints;
    let limits: Vec<[f64; 2]> = joints.iter().map(|joint| joint.limits.unwrap()).collect();
    let draw = |i: usize| -> Vec<f64> {
        let any = limits.iter().map(|[low, high]| rng.random_range(*low..*high));
        let mut q: Vec<f64> = any.collect();
        let (a, b) = (i % q.len(), (i / q.len()) % q.len());
        match i % 5 {
            0 => (q[a], q[b]) = (limits[a][0].max(0.0), limits[b][0].max(0.0)),
            1 => q[a] = limits[a][i / 5 % 2],
            _ => (),
        }
        q
    };
    let zero = limits.iter().map(|[low, high]| 0.0_f64.clamp(*low, *high)).collect();
    std::iter::once(zero).chain((1..count).map(draw)).collect()
}

/// A file of joints with a state in every row and a column of the user's own.
fn file(model: &Model, rows: &[Vec<f64>]) -> String {
    let kinds = kinds(model);
    let mut names: Vec<String> =
        kinds.iter().enumerate().map(|(j, kind)| joint_column("q", j, *kind)).collect();
    names.extend(["payload_kg", "temperature_c", "note", "dir1"].map(str::to_owned));
    let rows = rows.iter().enumerate().map(|(i, q)| {
        let joints = q.iter().zip(&kinds).map(|(q, kind)| joint_to_file(*kind, *q).to_string());
        let state = [(i % 4) as f64, 15.0 + (i % 20) as f64].map(|x| x.to_string());
        let note = format!("row, \"{i}\"");
        joints.chain(state).chain([note, ["1", "-1", "0", ""][i % 4].to_owned()]).collect()
    });
    csv_text(names.iter().map(String::as_str), rows)
}

fn read(text: &str, model: &Model, wanted: Wanted) -> Path {
    Path::parse(FilePath::new("path.csv"), text, &model.robot, wanted).unwrap()
}

fn column(path: &Path, name: &str) -> Vec<String> {
    let at = path.names.iter().position(|n| n == name).unwrap_or_else(|| panic!("{name}"));
    path.cells.iter().map(|row| row[at].clone()).collect()
}

fn numbers(path: &Path, name: &str) -> Vec<f64> {
    column(path, name).iter().map(|cell| cell.parse().unwrap()).collect()
}

const EXTRAPOLATE: CompensateOptions = CompensateOptions {
    task: None,
    trust_nominal_orientation: false,
    extrapolate: true,
    single: false,
    marker: None,
    start: None,
};

/// Off by the way of the point, m, and the turn, rad.
fn off(a: &Pose<f64>, b: &Pose<f64>) -> [f64; 2] {
    let rotation = a.rotation * b.rotation.transpose();
    let turn = Pose { rotation, translation: Vector3::zeros() }.rotation_vector().norm();
    [(a.translation - b.translation).norm(), turn]
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

/// One arm: what is written and read again meets what was commanded within what is
/// stated; no joint is moved by more than it may be, none beyond a limit, nothing is NaN, and
/// no tool ends farther from its target than it was.
fn promised(name: &str, model: &Model, task: Task) {
    let rows = commands(model, 1200, 3);
    let path = read(&file(model, &rows), model, Wanted::Either);
    let options = CompensateOptions { task: Some(task), ..EXTRAPOLATE };
    let found = compensate(model, &path, &options).unwrap();
    let text = compensated_csv(&path, &model.robot, &found).unwrap();
    let told = read(&text, model, Wanted::Joints);
    assert_eq!(column(&told, "note"), column(&path, "note"));
    assert_eq!(told.names.last().unwrap(), "dir1");
    let view = View::default();
    let (nominal, real) =
        (Forward::nominal(model, &view).unwrap(), Forward::real(model, &view).unwrap());
    let (wanted, reached) = (nominal.all(&path.data), real.all(&told.data));
    let before = real.all(&path.data);
    let (left, turned) = (numbers(&told, "left_mm"), numbers(&told, "left_deg"));
    // Near a limit a joint corrects less, and a SCARA has no other for its height.
    let held: Vec<bool> = column(&told, "clamped").iter().map(|cell| cell == "true").collect();
    let (mut misses, mut were) = (Vec::new(), Vec::new());
    for i in 0..rows.len() {
        let [point, turn] = off(&wanted[i], &reached[i]);
        assert!(point * 1e3 <= left[i], "{name} {i}: {} of {} mm", point * 1e3, left[i]);
        assert!(point * 1e3 > left[i] - 3e-6, "{name} {i}: stated {} mm", left[i]);
        assert!(turn.to_degrees() <= turned[i], "{name} {i}");
        for (j, (q, c)) in path.data.rows[i].q.iter().zip(&told.data.rows[i].q).enumerate() {
            assert!((c - q).abs() <= 0.03 + 1e-12, "{name} {i}, joint {}", j + 1);
            let [low, high] = model.robot.joints[j].limits.unwrap();
            assert!(*c >= low - 1e-12 && *c <= high + 1e-12, "{name} {i}, joint {}", j + 1);
        }
        let weighed = |[point, turn]: [f64; 2]| match task {
            Task::Pose => point.hypot(Settings::<f64, 6>::new(task).rotation_length * turn),
            _ => point,
        };
        let (a, b) = (weighed(off(&wanted[i], &before[i])), weighed([point, turn]));
        // The crate's promise; where it is damped, what bends a joint may add up to
        // 0.07 mm a mrad, and 1 mrad is more than the waves of these arms come to.
        let waves = if model.terms.len() > MAX_TERMS { 0.07e-3 } else { 0.0 };
        assert!(b <= a * 1.02 + 2e-6 + waves, "{name} {i}: {a} -> {b}");
        if !held[i] {
            misses.push(b);
            were.push(a);
        }
    }
    let [a, b] = [&were, &misses].map(|v| root_mean_square(v) * 1e3);
    println!("{name}, {task:?}, {} terms: {a:.3} -> {b:.4} mm RMS", model.terms.len());
    assert!(misses.len() > 300 && b < a / 4.0, "{name}, {task:?}: {a} -> {b} mm");
}

#[test]
fn what_is_written_meets_what_was_commanded() {
    for (i, (name, robot)) in arms().into_iter().enumerate() {
        for terms in [Terms::None, Terms::Few, Terms::Many] {
            promised(name, &model(robot, terms, i as u64), Task::Position);
        }
    }
}

#[test]
fn poses_as_well() {
    for (i, (name, robot)) in arms().into_iter().enumerate().take(3) {
        for terms in [Terms::Few, Terms::Many] {
            promised(name, &model(robot, terms, i as u64), Task::Pose);
        }
    }
}

/// The joints of the crate's compensator, driven tick by tick as a controller does it
/// with its ramp and its step limit, at the parameters that `pack` writes.
fn ticks<const N: usize>(model: &Model, path: &Path, task: Task) -> Vec<[f32; N]> {
    let options = PackOptions { sequence: Some(9), ..PackOptions::default() };
    let bytes = pack_with(model, &options).unwrap();
    let parameters: ArmParameters<f32, N> = Blob::check(&bytes).unwrap().parameters().unwrap();
    let rpy = truearm_host::model::Placement { xyz: model.robot.tool, rpy: model.robot.tool_rpy };
    let tool = rpy.pose();
    let tool = Pose {
        rotation: tool.rotation.map(|x| x as f32),
        translation: tool.translation.map(|x| x as f32),
    };
    let arm = Arm::new(&parameters).with_tool(tool);
    let each = path.data.rows.iter().map(|row| {
        let q: [f32; N] = core::array::from_fn(|j| row.q[j] as f32);
        let state = State {
            approach: core::array::from_fn(|j| Approach::of_motion(f32::from(row.directions[j]))),
            payload: row.payload.unwrap() as f32,
            temperature: row.temperature.unwrap() as f32,
            torque: None,
        };
        let settings = Settings { ramp_ticks: 5, ..Settings::new(task) };
        let mut compensator = Compensator::new(arm.clone(), settings, &q).unwrap();
        compensator.set_active(true);
        // The ramp, then 0.03 rad by at most 1 mrad a tick.
        (0..40).map(|_| compensator.tick(&q, &state).joints).last().unwrap()
    });
    each.collect()
}

fn bits<const N: usize>(name: &str, robot: &str, task: Task) {
    let model = model(robot, Terms::Few, 5);
    let path = read(&file(&model, &commands(&model, 300, 8)), &model, Wanted::Joints);
    let options = CompensateOptions { task: Some(task), single: true, ..EXTRAPOLATE };
    let found = compensate(&model, &path, &options).unwrap();
    let text = compensated_csv(&path, &model.robot, &found).unwrap();
    let told = read(&text, &model, Wanted::Joints);
    for (i, (expected, row)) in
        ticks::<N>(&model, &path, task).iter().zip(&told.data.rows).enumerate()
    {
        let written: Vec<u32> = row.q.iter().map(|q| (*q as f32).to_bits()).collect();
        assert_eq!(expected.map(f32::to_bits)[..], written[..], "{name} {i}");
    }
    let double =
        compensate(&model, &path, &CompensateOptions { single: false, ..options }).unwrap();
    let real = Forward::real(&model, &View::default()).unwrap();
    let (mut apart, mut rows) = (0.0_f64, 0);
    for ((a, b), row) in found.rows.iter().zip(&double.rows).zip(&path.data.rows) {
        let (
            Row::Corrected { joints: a, clamped: x, .. },
            Row::Corrected { joints: b, clamped: y, left, .. },
        ) = (a, b)
        else {
            panic!("joints are always reached");
        };
        // Held back or damped in one of them, it stops at another place.
        if !x && !y && left[0] < 1e-5 {
            apart = apart.max(off(&real.pose(row, a), &real.pose(row, b))[0]);
            rows += 1;
        }
    }
    println!("{name}, {task:?}: f32 and f64 {:.3} um apart in {rows} rows", apart * 1e6);
    assert!(apart < 5e-6 && rows > 100, "{name}: {apart} m in {rows} rows");
}

#[test]
fn single_precision_has_the_bits_of_the_controller() {
    bits::<6>("three parallel axes", robots::ALL[0], Task::Position);
    bits::<6>("three parallel axes", robots::ALL[0], Task::Pose);
    bits::<7>("seven joints", robots::ALL[4], Task::Position);
    bits::<7>("six joints on a rail", robots::ALL[5], Task::Pose);
    bits::<4>("SCARA", SCARA, Task::Position);
}

/// What the identification did not cover is left as it was commanded, digit for
/// digit, unless the user asks otherwise; it is said in either case.
#[test]
fn what_was_not_covered_is_not_invented() {
    let mut model = model(robots::ALL[0], Terms::Few, 1);
    model.covered[2] = Some([-0.5, 0.5]);
    let path = read(&file(&model, &commands(&model, 200, 6)), &model, Wanted::Joints);
    let inside = |i: usize| (-0.5..=0.5).contains(&path.data.rows[i].q[2]);
    let held = CompensateOptions { extrapolate: false, ..EXTRAPOLATE };
    for (options, extrapolated) in [(&held, false), (&EXTRAPOLATE, true)] {
        let found = compensate(&model, &path, options).unwrap();
        let text = compensated_csv(&path, &model.robot, &found).unwrap();
        let told = read(&text, &model, Wanted::Joints);
        let (mut out, covered) = (0, column(&told, "covered"));
        for (i, covered) in covered.iter().enumerate() {
            assert_eq!(covered, &inside(i).to_string());
            let same = (1..=6).all(|j| {
                let name = format!("q{j}_deg");
                column(&told, &name)[i] == column(&path, &name)[i]
            });
            assert_eq!(same, !inside(i) && !extrapolated, "row {i}");
            out += usize::from(!inside(i));
        }
        assert!(out > 50, "{out}");
    }
}

/// Joints from poses from joints: the tool is where it was, and a path of poses gives what
/// the path of its joints gives.
#[test]
fn poses_and_joints_are_two_ways_to_say_a_path() {
    for (name, robot) in arms() {
        let model = model(robot, Terms::Few, 2);
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        // A path: rows next to each other, through no pose in which arms are singular.
        let limits: Vec<[f64; 2]> =
            model.robot.joints.iter().map(|joint| joint.limits.unwrap()).collect();
        let middle = |[low, high]: &[f64; 2], share: f64| low + (high - low) * share;
        let (from, to): (Vec<f64>, Vec<f64>) = limits
            .iter()
            .map(|limit| {
                let share = rng.random_range(0.55..0.6);
                (middle(limit, share), middle(limit, share + 0.05))
            })
            .unzip();
        let rows: Vec<Vec<f64>> = (0..60)
            .map(|i| {
                let share = f64::from(i) / 59.0;
                from.iter().zip(&to).map(|(a, b)| a + (b - a) * share).collect()
            })
            .collect();
        let joints = read(&file(&model, &rows), &model, Wanted::Joints);
        let nominal = Forward::nominal(&model, &View::default()).unwrap();
        let poses = nominal.all(&joints.data);
        let text = forward_csv(&joints, &model.robot, &poses).unwrap();
        let path = read(&text, &model, Wanted::Poses);
        let inverse = Inverse::new(&nominal, &model.robot);
        let found = inverse.follow(&path.data, &path.targets, Some(&from));
        assert!(!found.chosen);
        for (i, (found, pose)) in found.rows.iter().zip(&poses).enumerate() {
            assert!(found.is_reached(), "{name} {i}: {found:?}");
            let again = off(&nominal.pose(&path.data.rows[i], &found.joints), pose);
            assert!(again[0] < REACHED_POINT && again[1] < 1e-5, "{name} {i}: {again:?}");
            for (q, [low, high]) in found.joints.iter().zip(&limits) {
                assert!(q >= low && q <= high);
            }
        }
        let written = inverse_csv(&path, &model.robot, &found.rows).unwrap();
        assert!(written.lines().next().unwrap().contains("reached"), "{written}");
        if kinds(&model).len() == 7 {
            continue; // The joints that reach a pose are a line of them.
        }
        let start = CompensateOptions { start: Some(from.clone()), ..EXTRAPOLATE };
        let of_poses = compensate(&model, &path, &start).unwrap();
        let of_joints = compensate(&model, &joints, &EXTRAPOLATE).unwrap();
        let of = |found: &Compensated| -> Vec<Vec<f64>> {
            let joints = found.rows.iter().map(|row| match row {
                Row::Corrected { joints, .. } => joints.clone(),
                Row::NotReached(left) => panic!("{name}: {left:?}"),
            });
            joints.collect()
        };
        for (a, b) in of(&of_poses).iter().zip(of(&of_joints)) {
            let apart = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-5, "{name}: {apart} rad or m");
        }
    }
}

/// A row of units below the header is no row: the user's cells stay with their own.
#[test]
fn a_row_of_units_moves_no_cell() {
    let model = model(robots::ALL[0], Terms::None, 2);
    let rows = file(&model, &commands(&model, 5, 6));
    let (header, rest) = rows.split_once('\n').unwrap();
    let units = "deg,deg,deg,deg,deg,deg,,,,";
    let path = read(&format!("{header}\n{units}\n{rest}"), &model, Wanted::Joints);
    let plain = read(&rows, &model, Wanted::Joints);
    assert_eq!(path.cells, plain.cells);
    assert_eq!(path.data.rows.len(), 5);
}

/// Out of reach is said, with what is left, and nothing is made up; the row after it goes
/// on from the one before.
#[test]
fn what_is_out_of_reach_is_not_invented() {
    let model = model(robots::ALL[0], Terms::None, 2);
    let nominal = Forward::nominal(&model, &View::default()).unwrap();
    let q = vec![0.3, -1.0, 1.2, -0.8, -1.3, 0.4];
    let joints = read(&file(&model, &[q.clone(), q.clone()]), &model, Wanted::Joints);
    let point = nominal.all(&joints.data)[0].translation * 1e3;
    let text = format!(
        "x_mm,y_mm,z_mm,note\n{0},{1},{2},a\n{0},{1},9000,b\n{0},{1},{2},c\n",
        point.x, point.y, point.z
    );
    let path = read(&text, &model, Wanted::Either);
    let options = CompensateOptions { start: Some(q), ..EXTRAPOLATE };
    let found = compensate(&model, &path, &options).unwrap();
    let Row::NotReached([left, _]) = found.rows[1] else { panic!("{:?}", found.rows[1]) };
    assert!((5.0..9.0).contains(&left), "{left}");
    let Row::Corrected { joints: a, .. } = &found.rows[0] else { panic!("a") };
    let Row::Corrected { joints: c, .. } = &found.rows[2] else { panic!("c") };
    assert!(a.iter().zip(c).all(|(a, c)| (a - c).abs() < 1e-6));
    let text = compensated_csv(&path, &model.robot, &found).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[2], ",,,,,,,,false,false,,,,,,,,b");
    let again = compensated_csv(
        &read(&text.replace(lines[2], lines[1]), &model, Wanted::Joints),
        &model.robot,
        &found,
    );
    assert!(again.unwrap_err().to_string().contains("compensated before"));
}

/// A model that was written and read again covers every row that it was fitted to, in both
/// numbers, and where the outermost rows are at the joint limits nothing is written beyond.
#[test]
fn every_row_that_was_fitted_is_covered() {
    let folder = tempfile::tempdir().unwrap();
    let written = folder.path().join("model.toml");
    for seed in 0..25 {
        for (name, robot) in arms() {
            let mut model = model(robot, Terms::None, seed);
            let path =
                read(&file(&model, &commands(&model, 25, 30 + seed)), &model, Wanted::Joints);
            model.covered = path.data.covered().into_iter().map(Some).collect();
            for (joint, range) in model.robot.joints.iter_mut().zip(&model.covered) {
                joint.limits = *range;
            }
            let mut ranges = Vec::new();
            for again in 0..3 {
                let text = model.to_toml();
                // What was read is written as it stood.
                let lines = text.lines().filter(|l| l.contains("covered") || l.contains("limits"));
                let new: Vec<String> = lines.map(str::to_owned).collect();
                assert!(new.len() == 2 * path.data.rows[0].q.len(), "{new:?}");
                assert!(again == 0 || new == ranges, "{name}, seed {seed}: {ranges:?} {new:?}");
                std::fs::write(&written, &text).unwrap();
                (model, ranges) = (Model::read(&written).unwrap(), new);
            }
            for single in [false, true] {
                let options = CompensateOptions { single, extrapolate: false, ..EXTRAPOLATE };
                let found = compensate(&model, &path, &options).unwrap();
                for (i, row) in found.rows.iter().enumerate() {
                    assert!(
                        matches!(row, Row::Corrected { covered: true, .. }),
                        "{name}, seed {seed}, row {i}: {row:?}"
                    );
                }
                let told = compensated_csv(&path, &model.robot, &found).unwrap();
                let told = read(&told, &model, Wanted::Joints);
                told.within_limits(&model.robot).unwrap();
            }
        }
    }
}

/// A command at the limit stays there in the file, whatever the controller's numbers make
/// of it, and has the controller's bits.
#[test]
fn no_joint_is_written_beyond_its_limit() {
    let robot = robots::ALL[0];
    for limit in [360.0_f64, 180.0, 170.0, 185.3, 99.9] {
        let mut model = model(robot, Terms::Few, 3);
        for joint in &mut model.robot.joints {
            joint.limits = Some([-limit.to_radians(), limit.to_radians()]);
        }
        model.covered = model.robot.joints.iter().map(|joint| joint.limits).collect();
        let mut text = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n".to_owned();
        for i in 0..12 {
            let sign = if i < 6 { limit } else { -limit };
            let q = (0..6).map(|j| if i % 6 == j { sign } else { 20.0 + f64::from(j) });
            text += &(q.map(|q| q.to_string()).collect::<Vec<_>>().join(",") + "\n");
        }
        let path = read(&text, &model, Wanted::Joints);
        for single in [true, false] {
            let options = CompensateOptions { single, ..EXTRAPOLATE };
            let found = compensate(&model, &path, &options).unwrap();
            let told = compensated_csv(&path, &model.robot, &found).unwrap();
            let told = read(&told, &model, Wanted::Joints);
            for j in 1..=6 {
                for (i, q) in numbers(&told, &format!("q{j}_deg")).iter().enumerate() {
                    assert!(q.abs() <= limit, "limit {limit}, row {i}, joint {j}: {q}");
                    let at = |q: f64| if single { f64::from(q.to_radians() as f32) } else { q };
                    let moved = i % 6 + 1 == j && at(q.abs()) != at(limit);
                    assert!(!moved, "limit {limit}, row {i}: {q}");
                }
            }
        }
    }
}

/// Without a start a path of poses begins in a configuration that the identification
/// covered, whole turns and all.
#[test]
fn a_configuration_that_is_chosen_is_covered() {
    for (name, robot) in [arms()[0], arms()[3]] {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        for seed in 0..20 {
            let mut model = model(robot, Terms::None, seed);
            for joint in &mut model.robot.joints {
                if joint.link.kind == JointKind::Revolute {
                    joint.limits = Some([-360.0_f64.to_radians(), 360.0_f64.to_radians()]);
                }
            }
            let ranges = model.robot.joints.iter().map(|joint| {
                let [low, high] = joint.limits.unwrap();
                let from = low + (high - low) * rng.random_range(0.02..0.8);
                [from, from + 0.1 * (high - low)]
            });
            let ranges: Vec<[f64; 2]> = ranges.collect();
            model.covered = ranges.iter().copied().map(Some).collect();
            // A short path from somewhere in the middle of what was covered.
            let from: Vec<f64> = ranges
                .iter()
                .map(|[low, high]| low + (high - low) * rng.random_range(0.3..0.6))
                .collect();
            let rows: Vec<Vec<f64>> = (0..10)
                .map(|i| {
                    let on = from.iter().zip(&ranges);
                    on.map(|(q, [low, high])| q + (high - low) * 0.01 * f64::from(i)).collect()
                })
                .collect();
            let joints = read(&file(&model, &rows), &model, Wanted::Joints);
            let nominal = Forward::nominal(&model, &View::default()).unwrap();
            let text = forward_csv(&joints, &model.robot, &nominal.all(&joints.data)).unwrap();
            let path = read(&text, &model, Wanted::Poses);
            let options = CompensateOptions { extrapolate: false, ..EXTRAPOLATE };
            let found = compensate(&model, &path, &options).unwrap();
            assert!(found.chosen);
            let first = &found.rows[0];
            assert!(
                matches!(first, Row::Corrected { covered: true, .. }),
                "{name}, seed {seed}: {first:?} of {from:?}"
            );
        }
    }
}

/// Which of several markers is the tool is said of the path: that `pack` would ask for it is no
/// reason to refuse, in the controller's numbers or in the host's, and numbers that no
/// controller takes are refused in either.
#[test]
fn one_of_several_markers_is_the_tool() {
    let mut two = model(robots::UR10_LIKE, Terms::None, 5);
    let (label, point) = two.markers[0].clone();
    two.markers.push(("second".to_owned(), point + Vector3::new(0.05, 0.02, -0.03)));
    assert!(pack_with(&two, &PackOptions::default()).is_err());
    let text = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n10,-80,70,-60,-80,20\n";
    let path = Path::parse(FilePath::new("p.csv"), text, &two.robot, Wanted::Joints).unwrap();
    let mut far = two.clone();
    far.corrections[0].a = 50.0;
    for single in [false, true] {
        for marker in [None, Some(label.clone()), Some("second".to_owned())] {
            let task = Some(Task::Position);
            let options = CompensateOptions { marker, single, task, ..Default::default() };
            let found = compensate(&two, &path, &options).unwrap();
            assert!(matches!(found.rows[0], Row::Corrected { .. }), "{options:?}");
            let refused = compensate(&far, &path, &options).unwrap_err();
            assert_eq!(refused.kind(), truearm_host::ErrorKind::Refused, "{refused}");
        }
    }
}
