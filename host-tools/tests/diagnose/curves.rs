//! Curves on their way from a model to the controller, and what the host predicts with
//! them.

use std::path::{Path, PathBuf};

use truearm::blob::Blob;
use truearm::{Arm, State};
use truearm_host::blob::image;
use truearm_host::blob::{Name, describe, diff, pack, unpack};
use truearm_host::evaluate::{Reregister, evaluate, state_on};
use truearm_host::identify::{Conditions, Options, Predictor, identify};
use truearm_host::model::{ErrorCurve, JointTables, Measurements, Model, Robot};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

fn curve(joint: u8) -> ErrorCurve {
    let f = |q: f64| 3e-4 * (5.0 * q + f64::from(joint)).sin() - 2e-4 * (31.0 * q).cos();
    ErrorCurve::of_function(joint, 256, 2e-5, f).unwrap().0
}

fn rows(robot: &Robot) -> Measurements {
    Measurements::read(&data("seed-table-8/measurements.csv"), robot).unwrap()
}

/// The paper's arm with five curves, in no order.
fn model() -> Model {
    let robot = Robot::read(&data("seed-table-8/robot.toml")).unwrap();
    let rows = rows(&robot);
    let mut model = identify(&robot, &rows, &Options::default(), &|_, _| ()).unwrap().model;
    model.curves = [3, 0, 4, 1, 2].map(curve).to_vec();
    model
}

#[test]
fn model_file_and_blob_keep_the_curves() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    let written = model();
    std::fs::write(&path, written.to_toml()).unwrap();
    let read = Model::read(&path).unwrap();
    assert!(!read.changed);
    assert_eq!(read.curves, [0, 1, 2, 3, 4].map(curve));
    let bytes = pack(&written, None).unwrap();
    assert_eq!(pack(&read, None).unwrap(), bytes, "whatever their order");
    assert!(bytes.len() < 4096);
    let blob = Blob::check(&bytes).unwrap();
    assert_eq!(blob.curves(), JointTables::new(&written.curves).curves());
    let name = Name { name: read.robot.name.clone(), serial: read.robot.serial.clone() };
    let back = unpack(&bytes, Path::new("a.bin"), Some(name)).unwrap();
    std::fs::write(&path, back.to_toml()).unwrap();
    let back = Model::read(&path).unwrap();
    assert_eq!(pack(&back, None).unwrap(), bytes);
    // A node that was changed by hand is seen.
    let text = written.to_toml();
    let at = text.find("nodes_rad = [").unwrap() + "nodes_rad = [".len();
    let end = at + text[at..].find(',').unwrap();
    let changed = text[..at].to_owned() + "1e-6" + &text[end..];
    std::fs::write(&path, changed).unwrap();
    assert!(Model::read(&path).unwrap().changed);
}

/// The host predicts what the controller computes.
#[test]
fn the_host_predicts_with_the_curves() {
    let model = model();
    let data = rows(&model.robot);
    let state = state_on(&model, &data, Reregister::Nothing).unwrap();
    let conditions = Conditions::of_model(&data, &model);
    let predictor = Predictor::new(&state);
    let bytes = pack(&model, None).unwrap();
    let parameters = Blob::check(&bytes).unwrap().parameters::<f64, 6>().unwrap();
    let arm = Arm::new(&parameters);
    let rigid =
        Arm::new(&truearm::ArmParameters { curves: truearm::Curves::NONE, ..parameters.clone() });
    let (mut moved, mut worst) = (0.0_f64, 0.0_f64);
    for (i, row) in data.rows.iter().enumerate() {
        let q: [f64; 6] = row.q.as_slice().try_into().unwrap();
        let at = |arm: &Arm<'_, f64, 6>| arm.real_pose_in(&q, &State::at(20.0)).translation;
        let rigid_conditions = Conditions::new(&data, &model.robot);
        let base = state.bases[row.station].rotation;
        let by_host = base.transpose()
            * (predictor.point(row, &conditions.rows[i])
                - predictor.point(row, &rigid_conditions.rows[i]));
        let turn =
            truearm::Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
        let by_controller = turn.rotation.transpose() * (at(&arm) - at(&rigid));
        worst = worst.max((by_host - by_controller).norm());
        moved = moved.max(by_host.norm());
    }
    // The blob's geometry is rounded to binary32, of which the difference sees a share.
    assert!(moved > 2e-4 && worst < 1e-8, "moved {moved:e}, apart {worst:e}");

    // Curves that the arm does not have make it worse; the nominal figure has none.
    let with = evaluate(&model, &data, Reregister::Nothing).unwrap();
    let without = evaluate(&Model { curves: Vec::new(), ..model }, &data, Reregister::Nothing);
    let without = without.unwrap();
    assert!(
        with.stats.unwrap().mean_mm > without.stats.unwrap().mean_mm + 0.05,
        "{with:?} {without:?}"
    );
    assert_eq!(with.nominal_rms_mm, without.nominal_rms_mm);
}

#[test]
fn curves_are_told_in_words_and_in_sources() {
    let model = model();
    let bytes = pack(&model, Some(1)).unwrap();
    let blob = Blob::check(&bytes).unwrap();
    let text = describe(&blob, bytes.len(), false);
    let lines: Vec<&str> = text.lines().filter(|l| l.contains("joint-error-curve")).collect();
    assert_eq!(lines.len(), 5, "{text}");
    let words: Vec<&str> = lines[2].split_whitespace().collect();
    assert_eq!(words[..4], ["3", "joint-error-curve", "3", "256"]);
    assert!((words[4].parse::<f64>().unwrap() - 0.5).abs() < 0.01, "{words:?}");
    assert_eq!(words[6], "0.0200");
    for text in [image::c(&bytes, &blob), image::rust(&bytes, &blob)] {
        assert!(text.contains("6 joints, 0 terms, 5 curves, "), "{}", &text[..300]);
    }

    let mut other = model.clone();
    other.curves[1] = ErrorCurve::of_function(0, 64, 1e-5, |q| 1e-4 * q.sin()).unwrap().0;
    other.curves.pop();
    let changed = diff(&bytes, &pack(&other, Some(2)).unwrap(), 200, 1).unwrap();
    for words in
        ["curve of joint 1: 256 nodes", "64 nodes, up to 0.1000 mrad", "curve of joint 3: gone"]
    {
        assert!(changed.contains(words), "{words} in {changed}");
    }
    let back = diff(&pack(&other, Some(2)).unwrap(), &bytes, 200, 1).unwrap();
    assert!(back.contains("curve of joint 3: new, 256 nodes"), "{back}");
}

/// What is wrong in a file is named where it stands.
#[test]
fn a_second_curve_of_a_joint_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    let text = model().to_toml();
    let again = text.replacen("[[curves]]\njoint = 2\n", "[[curves]]\njoint = 1\n", 1);
    assert_ne!(again, text);
    std::fs::write(&path, again).unwrap();
    let error = Model::read(&path).unwrap_err().to_string();
    assert!(error.contains("[[curves]] entry 2: a second curve of joint 1"), "{error}");
}
