//! `[base]` and `[tool] rpy_deg`: an arm that has them is the same arm without
//! them whose files are transformed by hand.

use std::fmt::Write as _;
use std::path::Path;

use nalgebra::{Rotation3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;
use truearm_host::blob::{notes, pack, unpack};
use truearm_host::files::poses_csv;
use truearm_host::identify::{Conditions, Options, identify};
use truearm_host::model::{Commanded, Measurements, Model, Robot, Sight, Workspace};
use truearm_host::verify::verify;

const ARM: &str = include_str!("../../../tests/data/seed-table-8/robot.toml");
const ROWS: &str = include_str!("../../../tests/data/seed-table-8/measurements.csv");
/// A wall: joint 1 points along x of the files, where pitch is at its pole.
const XYZ_MM: [f64; 3] = [1200.0, -350.0, 800.0];
const RPY_DEG: [f64; 3] = [30.0, 90.0, -70.0];
const GRAVITY: [f64; 3] = [0.3, -0.2, -9.8];

/// File coordinates of the frame before joint 1, put together by hand.
fn base() -> Pose<f64> {
    let [roll, pitch, yaw] = RPY_DEG.map(f64::to_radians);
    let about = |axis: Vector3<f64>, angle| Rotation3::new(axis * angle);
    let turn = about(Vector3::z(), yaw) * about(Vector3::y(), pitch) * about(Vector3::x(), roll);
    Pose { rotation: turn.into_inner(), translation: Vector3::from(XYZ_MM) * 1e-3 }
}

/// With masses, gravity as given, and tables `more`.
fn robot(gravity: Vector3<f64>, more: &str) -> Robot {
    let [x, y, z]: [f64; 3] = gravity.into();
    let down = format!("gravity_m_s2 = [{x:?}, {y:?}, {z:?}]");
    let mut text = ARM.replace("gravity_m_s2 = [0.0, 0.0, -9.81]", &down) + more + "\n";
    (0..6).for_each(|_| text += "[[links]]\nmass_kg = 3.0\ncom_mm = [-200.0, 10.0, 50.0]\n");
    Robot::parse(Path::new("robot.toml"), &text).unwrap()
}

/// On the wall, and the same arm by hand.
fn both() -> [Robot; 2] {
    let wall = robot(
        Vector3::from(GRAVITY),
        &format!("[base]\nxyz_mm = {XYZ_MM:?}\nrpy_deg = {RPY_DEG:?}"),
    );
    [wall, robot(base().rotation.transpose() * Vector3::from(GRAVITY), "")]
}

fn identified(robot: &Robot) -> Model {
    let data = Measurements::parse(Path::new("m.csv"), ROWS, robot).unwrap();
    identify(robot, &data, &Options::default(), &|_, _| ()).unwrap().model
}

/// As it is read from its own file.
fn reread(model: &Model) -> Model {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    std::fs::write(&path, model.to_toml()).unwrap();
    let read = Model::read(&path).unwrap();
    assert!(!read.changed);
    read
}

#[test]
fn gravity_loads_the_same_arm() {
    let loads = both().map(|robot| {
        let data = Measurements::parse(Path::new("m.csv"), ROWS, &robot).unwrap();
        Conditions::new(&data, &robot).rows
    });
    for (a, b) in loads[0].iter().zip(&loads[1]) {
        let torques = a.torque.iter().zip(&b.torque);
        let moments = a.moment.iter().zip(&b.moment);
        assert!(torques.chain(moments).all(|(a, b)| (a - b).abs() < 1e-10), "{a:?} {b:?}");
    }
    assert!(loads[0].iter().any(|row| row.torque[0].abs() > 1.0), "joint 1 carries on a wall");
}

#[test]
fn the_model_and_its_blob_are_the_same() {
    let [wall, floor] = both().map(|robot| identified(&robot));
    let read = reread(&wall);
    assert!((read.robot.base.xyz - wall.robot.base.xyz).norm() < 1e-14);
    assert!((read.robot.base.rpy - wall.robot.base.rpy).norm() < 1e-14);
    assert!((read.frame_translation - wall.frame_translation).norm() < 1e-14);
    assert!((read.frame_rotation - wall.frame_rotation).norm() < 1e-14);
    for ((_, a), (_, b)) in read.stations.iter().zip(&wall.stations) {
        assert!((a.translation - b.translation).norm() < 1e-12);
        assert!((a.rotation - b.rotation).norm() < 1e-12);
    }
    // The station stands in the file where it sees the frame of the files.
    let station = wall.stations[0].1.compose(&base().inverse()).translation * 1e3;
    let told: toml::Table = wall.to_toml().parse().unwrap();
    let told: Vec<f64> = told["stations"][0]["xyz_mm"].clone().try_into().unwrap();
    assert!((Vector3::from_vec(told) - station).norm() < 1e-9);
    // The controller knows nothing of the wall: the two blobs agree, and what is
    // unpacked of one has no [base].
    let unpacked = [&read, &floor].map(|model| {
        let bytes = pack(model, Some(1)).unwrap();
        unpack(&bytes, Path::new("a.bin"), None).unwrap()
    });
    let [a, b] = &unpacked;
    assert_eq!((a.robot.base, &a.corrections), (b.robot.base, &b.corrections));
    assert!((a.robot.gravity.unwrap() - b.robot.gravity.unwrap()).norm() < 1e-6);
    assert!((a.frame_translation - b.frame_translation).norm() < 1e-9);
    assert!((a.frame_rotation - b.frame_rotation).norm() < 1e-9);
    assert!(notes(&read).iter().any(|note| note.starts_with("[base] stays on the host")));
}

/// Points commanded in the coordinates of the files, and of the frame before
/// joint 1: the same errors, turned.
#[test]
fn commanded_points_are_verified_alike() {
    let [wall, floor] = both().map(|robot| identified(&robot));
    let data = Measurements::parse(Path::new("m.csv"), ROWS, &floor.robot).unwrap();
    let target = floor.robot.nominal_target();
    let table = |to_file: Pose<f64>| {
        let mut text = "cmd_x_mm,cmd_y_mm,cmd_z_mm,x_mm,y_mm,z_mm\n".to_owned();
        for row in &data.rows {
            let p = to_file.transform_point(&target(&row.q).translation) * 1e3;
            let m = row.measured.point() * 1e3;
            writeln!(text, "{},{},{},{},{},{}", p.x, p.y, p.z, m.x, m.y, m.z).unwrap();
        }
        text
    };
    let [a, b] = [(&wall, base()), (&floor, Pose::identity())].map(|(model, to_file)| {
        let commanded = Commanded::parse(Path::new("c.csv"), &table(to_file), &model.robot);
        verify(&reread(model), &commanded.unwrap(), false).unwrap()
    });
    let [of_a, of_b] = [&a, &b].map(|found| found.points.as_ref().unwrap());
    assert!((of_a.errors.rms_mm - of_b.errors.rms_mm).abs() < 1e-8 && of_a.errors.rms_mm > 0.1);
    assert!((of_a.accuracy.max_mm - of_b.accuracy.max_mm).abs() < 1e-8);
    for (a, b) in a.row_errors.iter().zip(&b.row_errors) {
        let (a, b) = (a.unwrap(), b.unwrap());
        assert!((a - base().rotation * b).norm() < 1e-11, "{a} {b}");
    }
}

/// Boxes and trackers are in the coordinates of the files, and so is where the
/// nominal target will be.
#[test]
fn poses_are_planned_where_the_files_are() {
    let [wall, floor] = both();
    let limits = Some(vec![[-1.5, 1.5]; 6]);
    let tracker = Vector3::new(3.0, 0.5, 0.4);
    let sight = |to_file: Pose<f64>| Sight {
        tracker: to_file.transform_point(&tracker),
        axis: Vector3::z(),
        cone: 0.8,
    };
    let poses = [(&wall, base()), (&floor, Pose::identity())].map(|(robot, to_file)| {
        let mut workspace = Workspace::new(robot, limits.clone()).unwrap();
        workspace.sight = Some(sight(to_file));
        workspace.sample(robot, 20, &mut ChaCha8Rng::seed_from_u64(3)).unwrap()
    });
    assert_eq!(poses[0], poses[1]);
    let places = [&wall, &floor].map(|robot| {
        let text = poses_csv(robot, "q", &poses[0], &[]);
        let numbers = |line: &str| -> Vec<f64> {
            line.split(',').map(|cell| cell.parse().unwrap()).collect()
        };
        text.lines().skip(1).map(numbers).map(|row| row[6..9].to_vec()).collect::<Vec<_>>()
    });
    for (a, b) in places[0].iter().zip(&places[1]) {
        let [a, b] = [a, b].map(|p| Vector3::new(p[0], p[1], p[2]) * 1e-3);
        assert!((a - base().transform_point(&b)).norm() < 2e-6);
    }
}

#[test]
fn a_turned_tool_faces_another_way() {
    let turned = robot(Vector3::from(GRAVITY), "");
    let text = ARM.replacen("[tool]", "[tool]\nrpy_deg = [20.0, -35.0, 100.0]", 1);
    assert_ne!(text, ARM);
    let with = Robot::parse(Path::new("robot.toml"), &text).unwrap();
    let [roll, pitch, yaw] = [20_f64, -35.0, 100.0].map(f64::to_radians);
    let turn = Rotation3::from_euler_angles(roll, pitch, yaw);
    let sample = |robot: &Robot, axis| {
        let mut workspace = Workspace::new(robot, Some(vec![[-1.5, 1.5]; 6])).unwrap();
        let tracker = Vector3::new(3.0, 0.5, 0.4);
        workspace.sight = Some(Sight { tracker, axis, cone: 0.6 });
        workspace.sample(robot, 20, &mut ChaCha8Rng::seed_from_u64(5)).unwrap()
    };
    assert_eq!(sample(&with, Vector3::z()), sample(&turned, turn * Vector3::z()));
    let model = reread(&identified(&with));
    assert!((model.robot.tool_rpy - with.tool_rpy).norm() < 1e-14);
}
