//! `truearm fleet` from folder to folder, and tolerances of a type in robot.toml.

mod simulated;

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use simulated::{Truth, UR10_LIKE, normal, robot};
use truearm::MdhParameters;
use truearm_host::identify::{Options, identify};
use truearm_host::model::{Measurements, Model, Robot};

const SIGMA: f64 = 3e-5;

/// Zeros of 2 mrad, all else of 0.1 tolerances; joint 3 is bent by 15 mrad where asked.
fn measured(poses: usize, bent: bool, rng: &mut ChaCha8Rng) -> String {
    let robot = robot(UR10_LIKE);
    let mut truth = Truth::draw_sized(&robot, 1, 1, 0.0, rng);
    for (i, link) in truth.links.iter_mut().enumerate() {
        let sizes = [1e-4, 1e-4, 2e-3, 1e-4, 1e-4];
        let mut off: [f64; 5] = core::array::from_fn(|k| sizes[k] * normal(rng));
        off[0] += if bent && i == 2 { 15e-3 } else { 0.0 };
        *link = link.corrected(&MdhParameters::from_array(off));
    }
    truth.measure(poses, SIGMA, rng)
}

/// A folder of arms `arm-1..`; the one that is bent, from 1, or none.
fn fleet(arms: usize, bent: usize) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    fs::write(folder.path().join("robot.toml"), UR10_LIKE).unwrap();
    for k in 1..=arms {
        let arm = folder.path().join(format!("arm-{k}"));
        fs::create_dir(&arm).unwrap();
        fs::write(arm.join("measurements.csv"), measured(18, k == bent, &mut rng)).unwrap();
    }
    folder
}

fn truearm(folder: &Path, line: &str) -> (bool, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    let ran = command.current_dir(folder).args(line.split(' ')).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap().replace("\r\n", "\n");
    (ran.status.success(), text(ran.stdout), text(ran.stderr))
}

fn report(folder: &Path, line: &str) -> Value {
    let (good, out, error) = truearm(folder, line);
    assert!(good, "{error}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn a_fleet_teaches_the_next_arm() {
    let folder = fleet(7, 4);
    let found = report(folder.path(), "fleet . --out out --json");
    assert_eq!(found["schema"], "truearm-fleet-1");
    let differs: Vec<bool> = found["arms"]
        .as_array()
        .unwrap()
        .iter()
        .map(|arm| arm["judgement"]["differs"].as_bool().unwrap())
        .collect();
    assert_eq!(differs, [false, false, false, true, false, false, false]);
    let bent = &found["arms"][3]["judgement"];
    assert!(bent["sigmas"].as_f64().unwrap().abs() > 5.0, "{bent}");
    let tolerance = |k: usize| found["parameters"][k]["tolerance"].as_f64().unwrap();
    // mm of joint 2's a, degrees of its zero.
    assert!(tolerance(6) < 0.4 && tolerance(7) > 0.05, "{} {}", tolerance(6), tolerance(7));
    // What was written is what identify takes; a second run takes its own folder for no arm.
    let out = folder.path().join("out");
    let taught = Robot::read(&out.join("robot.toml")).unwrap();
    assert!(taught.joints.iter().all(|j| j.prior.tolerance.iter().all(Option::is_some)));
    assert!(taught.warnings.is_empty(), "{:?}", taught.warnings);
    let model = Model::read(&out.join("arm-1/model.toml")).unwrap();
    assert_eq!(model.provenance.poses, 18);
    let again = report(folder.path(), "fleet . --out out --json");
    assert_eq!(found["arms"], again["arms"]);
    // An edited file is not written over.
    let text = fs::read_to_string(out.join("robot.toml")).unwrap();
    fs::write(out.join("robot.toml"), text + "# mine\n").unwrap();
    let (good, _, error) = truearm(folder.path(), "fleet . --out out");
    assert!(!good && error.contains("not as truearm wrote it"), "{error}");
}

/// Rows that are far off in most arms are said to be; in one of four they are that arm's.
#[test]
fn what_geometry_lacks_is_warned_of() {
    let folder = fleet(4, 0);
    let robot = fs::read_to_string(folder.path().join("robot.toml")).unwrap();
    let stated = |arms: std::ops::RangeInclusive<usize>| {
        let finer = robot.replace("measurement_sigma_mm = 0.02", "measurement_sigma_mm = 0.002");
        assert_ne!(finer, robot);
        for k in arms {
            fs::write(folder.path().join(format!("arm-{k}/robot.toml")), &finer).unwrap();
        }
        report(folder.path(), "fleet . --json")
    };
    let said = |found: &Value| found["warnings"].to_string().contains("what geometry lacks");
    assert!(!said(&report(folder.path(), "fleet . --json")));
    let one = stated(1..=1);
    assert!(!said(&one), "{one}");
    let noise = one["arms"][0]["judgement"]["noise_over_stated"].as_f64().unwrap();
    assert!((5.0..20.0).contains(&noise), "{noise}");
    let most = stated(2..=3);
    assert!(said(&most) && most["warnings"].to_string().contains("`truearm diagnose`"), "{most}");
}

#[test]
fn one_arm_that_fails_is_named_and_the_others_are_not_lost() {
    let folder = fleet(4, 0);
    let arm = |k: usize| folder.path().join(format!("arm-{k}"));
    fs::remove_file(arm(1).join("measurements.csv")).unwrap();
    let last = UR10_LIKE.lines().find(|line| line.contains("92.2")).unwrap();
    fs::write(arm(2).join("robot.toml"), UR10_LIKE.replace(last, "")).unwrap();
    let moved = UR10_LIKE.replace("a_mm = -612", "a_mm = -619");
    fs::write(arm(3).join("robot.toml"), moved).unwrap();
    let found = report(folder.path(), "fleet . --json");
    let failure = |k: usize| found["arms"][k]["failure"].as_str().unwrap_or_default();
    assert!(failure(0).contains("measurements.csv"), "{}", failure(0));
    assert!(failure(1).contains("5 joints, the type has 6"), "{}", failure(1));
    assert!(failure(2).contains("is not the nominal one of the type"), "{}", failure(2));
    assert!(found["arms"][3]["judgement"]["differs"] == false, "{}", found["arms"][3]);
    let (_, words, _) = truearm(folder.path(), "fleet .");
    assert!(
        words.contains("1 arm in 4 folders") && words.contains("arm-1 is not identified"),
        "{words}"
    );
    fs::remove_file(arm(4).join("measurements.csv")).unwrap();
    let (good, _, error) = truearm(folder.path(), "fleet .");
    assert!(!good && error.contains("no arm could be identified"), "{error}");
}

#[test]
fn what_is_no_fleet_is_refused() {
    let folder = fleet(1, 0);
    for (line, says) in [
        ("fleet nowhere", "nowhere"),
        ("fleet arm-1", "no folder of an arm"),
        ("fleet . --out .", "the arms are read there"),
    ] {
        let (good, _, error) = truearm(folder.path(), line);
        assert!(!good && error.contains(says), "{line}: {error}");
    }
}

/// Keys of the first joint, and what is said of them.
#[test]
fn tolerances_that_make_no_sense_are_refused() {
    let with = |keys: &str| {
        let joint = format!("theta_offset_deg = 0, {keys} }}");
        let text = UR10_LIKE.replacen("theta_offset_deg = 0 }", &joint, 1);
        Robot::parse(Path::new("robot.toml"), &text)
    };
    let sound = with("tolerance = { a_mm = 0.2 }, expected = { alpha_deg = -0.1 }").unwrap();
    assert_eq!(sound.joints[0].prior.tolerance, [None, Some(2e-4), None, None, None]);
    assert!((sound.joints[0].prior.expected[0] + 0.1_f64.to_radians()).abs() < 1e-15);
    for (line, says) in [
        ("tolerance = { a_mm = -0.2 }", "tolerance.a_mm = -0.2"),
        ("tolerance = { a_mm = 0 }", "tolerance.a_mm = 0"),
        ("tolerance = { d_offset_mm = 1.0 }", "d_mm is of revolute joints"),
        ("expected = { beta_deg = nan }", "expected.beta_deg = NaN"),
        ("expected = 3.0", "invalid type"),
    ] {
        let error = with(line).unwrap_err().to_string();
        assert!(error.contains(says), "{line}: {error}");
    }
    let slip = with("tolerance = { alfa_deg = 1.0 }").unwrap();
    assert!(slip.warnings[0].contains("alpha_deg"), "{:?}", slip.warnings);
}

fn with_tolerance(robot: &Robot, tolerance: Option<f64>) -> Robot {
    let mut robot = robot.clone();
    robot.joints.iter_mut().for_each(|joint| joint.prior.tolerance = [tolerance; 5]);
    robot
}

#[test]
fn stating_what_is_assumed_changes_no_bit() {
    let plain = robot(UR10_LIKE);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let text = Truth::draw(&plain, 1, 1, &mut rng).measure(30, SIGMA, &mut rng);
    let data = Measurements::parse(Path::new("m.csv"), &text, &plain).unwrap();
    let found = |robot: &Robot| identify(robot, &data, &Options::default(), &|_, _| ()).unwrap();
    let (none, stated) = (found(&plain), found(&with_tolerance(&plain, Some(1e-3))));
    assert_eq!(none.model.corrections, stated.model.corrections);
    assert_eq!(none.figures, stated.figures);
    // A tolerance that is not the usual one does: corrections are kept smaller.
    let tight = found(&with_tolerance(&plain, Some(1e-6)));
    assert_ne!(none.figures.correction_norm, tight.figures.correction_norm);
}

/// Of two offsets along parallel axes the poses say the sum: the file says the rest.
#[test]
fn corrections_stay_near_what_is_expected() {
    let mut told = robot(UR10_LIKE);
    told.joints[2].prior.expected[3] = -4e-3;
    told.joints[3].prior.expected[3] = 4e-3;
    let text = measured(30, false, &mut ChaCha8Rng::seed_from_u64(4));
    let data = Measurements::parse(Path::new("m.csv"), &text, &told).unwrap();
    let found = identify(&told, &data, &Options::default(), &|_, _| ()).unwrap();
    let d: Vec<f64> = found.model.corrections.iter().map(|c| c.d).collect();
    assert!((d[2] + 4e-3).abs() < 3e-4 && (d[3] - 4e-3).abs() < 3e-4, "{d:?}");
    // In the report from nominal, as in the model.
    let bar = &found.figures.uncertainty.parameters[18];
    assert!((bar.correction - d[3] * 1e3).abs() < 1e-9, "{bar:?}");
}
