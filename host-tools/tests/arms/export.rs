//! Presets, tables, and an identified arm on its way out.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::plain_chain::{apart, frame, pose};
use nalgebra::{Matrix4, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{LinkParameter, MdhParameters, Pose};
use truearm_host::convert::presets::{PRESETS, Preset};
use truearm_host::convert::table::{
    Convention, Table, Units, mdh_csv, robot_of_table, standard_dh, standard_dh_csv,
};
use truearm_host::convert::urdf::{Document, Ends, calibrated_like, robot_of_urdf, urdf_text};
use truearm_host::convert::{Identified, TEMPLATE, left_out, ur_calibration};
use truearm_host::model::arm::chain;
use truearm_host::model::{Model, ModelTerm, Provenance, Robot};

fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn preset(name: &str) -> Robot {
    Robot::parse(Path::new("robot.toml"), Preset::find(name).unwrap().text).unwrap()
}

/// An identified arm: this one with seeded errors in every parameter, a frame
/// and a marker.
fn identified(robot: &Robot, seed: u64) -> Model {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut small = |scale: f64| rng.random_range(-scale..scale);
    let mut three = |scale: f64| Vector3::from_fn(|_, _| small(scale));
    let (frame_translation, frame_rotation) = (three(1e-3), three(1e-3));
    let marker = robot.tool + three(5e-3);
    let n = robot.joints.len();
    let corrections =
        (0..n).map(|_| MdhParameters::from_array(LinkParameter::ALL.map(|_| three(1e-3).x)));
    Model {
        corrections: corrections.collect(),
        robot: robot.clone(),
        uncertainties: Vec::new(),
        covered: vec![Some([-1.5, 1.5]); n],
        terms: Vec::new(),
        curves: Vec::new(),
        stations: Vec::new(),
        markers: vec![(String::new(), marker)],
        not_measured: Vec::new(),
        instruments: Vec::new(),
        frame_translation,
        frame_rotation,
        provenance: Provenance::default(),
        unidentifiable: Vec::new(),
        orientation_identified: true,
        robot_id: None,
        covariance: None,
        changed: false,
        gram: None,
    }
}

/// The identified point in the coordinates of the files.
fn identified_point(model: &Model, q: &[f64]) -> Vector3<f64> {
    let frame = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let base = model.robot.base.pose().compose(&frame);
    chain(&model.links(), base, model.markers[0].1).pose(q).translation
}

fn poses(joints: usize, count: usize) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    (0..count).map(|_| (0..joints).map(|_| rng.random_range(-1.5..1.5)).collect()).collect()
}

fn point(pose: &Matrix4<f64>) -> Vector3<f64> {
    pose.fixed_view::<3, 1>(0, 3).into_owned()
}

/// The target at joint values zero, mm, and where its z points, as the data
/// sheets and manuals show the arm; for the URs the sums of their table.
#[test]
fn presets_are_where_they_are_published() {
    let up = [0.0, 0.0, 1.0];
    let down = [0.0, 0.0, -1.0];
    let ahead = [1.0, 0.0, 0.0];
    let aside = [0.0, -1.0, 0.0];
    let homes = [
        ("ur3", [-243.65 - 213.25, -112.35 - 81.9, 151.9 - 85.35], aside),
        ("ur5", [-425.0 - 392.25, -109.15 - 82.3, 89.159 - 94.65], aside),
        ("ur10", [-612.0 - 572.3, -163.941 - 92.2, 127.3 - 115.7], aside),
        ("ur3e", [-243.55 - 213.2, -131.05 - 92.1, 151.85 - 85.35], aside),
        ("ur5e", [-425.0 - 392.2, -133.3 - 99.6, 162.5 - 99.7], aside),
        ("ur10e", [-612.7 - 571.55, -174.15 - 116.55, 180.7 - 119.85], aside),
        ("ur16e", [-478.4 - 360.0, -174.15 - 116.55, 180.7 - 119.85], aside),
        ("ur20", [-862.0 - 728.7, -201.0 - 154.3, 236.3 - 159.3], aside),
        ("ur30", [-637.0 - 503.7, -201.0 - 154.3, 236.3 - 159.3], aside),
        ("panda", [88.0, 0.0, 333.0 + 316.0 + 384.0 - 107.0], down),
        ("fr3", [88.0, 0.0, 333.0 + 316.0 + 384.0 - 107.0], down),
        ("lbr-iiwa-7-r800", [0.0, 0.0, 1266.0], up),
        ("lbr-iiwa-14-r820", [0.0, 0.0, 1306.0], up),
        ("kr-6-r900", [980.0, 0.0, 435.0], ahead),
        ("irb-120", [374.0, 0.0, 630.0], ahead),
        ("puma-560", [452.1, -150.05, 431.8], up),
        ("gen3", [0.0, -24.8501, 1187.385], up),
        ("xarm6", [207.0, 0.0, 112.0], down),
        ("xarm7", [206.0, 0.0, 120.5], down),
    ];
    assert_eq!(homes.len(), PRESETS.len());
    for (name, xyz, z) in homes {
        let robot = preset(name);
        let home = robot.nominal_target()(&vec![0.0; robot.joints.len()]);
        let off = (home.translation * 1e3 - Vector3::from(xyz)).norm();
        assert!(off < 1e-6, "{name}: {}", home.translation);
        let turned = (home.rotation.column(2) - Vector3::from(z)).norm();
        assert!(turned < 1e-9, "{name}: {}", home.rotation);
        let found = Preset::find(&name.to_uppercase().replace('-', "_")).unwrap();
        assert!(found.source().len() > 20 && found.title() == robot.name, "{name}");
        assert_eq!(robot.warnings.len(), 1, "{name}: {:?}", robot.warnings);
    }
}

/// The senses of the axes: a small turn of each joint moves the arm of the
/// preset as it moves that of the URDF, whose axes are KUKA's, ABB's...
#[test]
fn presets_turn_as_published() {
    for (name, urdf, base, tip) in [
        ("kr-6-r900", "kr6_r900", "link_0", "tool0"),
        ("irb-120", "irb120", "link_0", "tool0"),
        ("panda", "panda", "panda_link0", "panda_link8"),
        ("lbr-iiwa-14-r820", "iiwa14", "link_0", "ee"),
        ("ur5e", "ur5e", "base_link_inertia", "tool0"),
        ("puma-560", "puma560", "l0", "l6"),
    ] {
        let robot = preset(name);
        let given = urdf_rs::read_file(data(&format!("tests/data/urdf/{urdf}.urdf"))).unwrap();
        let target = robot.nominal_target();
        for q in poses(robot.joints.len(), 100) {
            let off = target(&q).translation - point(&pose(&given, base, tip, &q));
            // The UR's file rounds its quarter turns to 10 digits.
            assert!(off.norm() < 1e-8, "{name}: {off}");
        }
    }
}

#[test]
fn the_template_is_a_robot() {
    let robot = Robot::parse(Path::new("robot.toml"), TEMPLATE).unwrap();
    assert_eq!((robot.joints.len(), robot.warnings.len()), (3, 0));
    // And with every remark that holds a key taken as one.
    let full: String = TEMPLATE
        .lines()
        .map(|line| {
            let bare = line.strip_prefix("# ").unwrap_or(line);
            let word = bare.split_once(" = ").is_some_and(|(key, _)| !key.contains(' '));
            let key = word || bare.starts_with('[');
            format!("{}\n", if key { bare } else { line })
        })
        .collect();
    let robot = Robot::parse(Path::new("robot.toml"), &full).unwrap();
    assert_eq!(robot.joints.len(), 4);
    assert!(robot.warnings.iter().all(|w| w.contains("[[links]]")), "{:?}", robot.warnings);
}

/// Read with urdf-rs into plain matrices, the URDF has the identified points.
#[test]
fn a_calibrated_urdf_is_the_identified_arm() {
    let scara = robot_of_urdf(
        &data("tests/data/urdf/irb910sc.urdf"),
        &Ends { base: None, tip: Some("link_4".to_owned()) },
    );
    let scara = Robot::parse(Path::new("robot.toml"), &scara.unwrap().text).unwrap();
    let arms = PRESETS.map(|p| preset(p.name)).into_iter().chain([scara]);
    for (k, robot) in arms.enumerate() {
        let model = identified(&robot, k as u64);
        let arm = Identified::of(&model, None).unwrap();
        let urdf = urdf_rs::read_from_string(&urdf_text(&model, &arm)).unwrap();
        for q in poses(robot.joints.len(), 1000 / 5) {
            let given = point(&pose(&urdf, "base_link", "target", &q));
            let off = (given - identified_point(&model, &q)).norm();
            assert!(off < 1e-9, "{}: {off:e}", robot.name);
        }
    }
}

/// In the user's own file only the origins change, and the target is added.
#[test]
fn a_urdf_is_calibrated_in_place() {
    for (name, base, tip) in [
        ("ur5e", "base_link", "tool0"),
        ("kr6_r900", "link_0", "tool0"),
        ("iiwa14", "world", "ee"),
        ("irb910sc", "link_0", "link_4"),
        ("panda", "panda_link0", "panda_link8"),
        ("xarm6", "link0", "link6"),
        ("puma560", "l0", "l6"),
    ] {
        let path = data(&format!("tests/data/urdf/{name}.urdf"));
        let ends = Ends { base: Some(base.to_owned()), tip: Some(tip.to_owned()) };
        let made = robot_of_urdf(&path, &ends).unwrap();
        let robot = Robot::parse(Path::new("robot.toml"), &made.text).unwrap();
        let model = identified(&robot, 5);
        let arm = Identified::of(&model, None).unwrap();
        let document = Document::read(&path).unwrap();
        let text = calibrated_like(&document, &ends, &model, &arm).unwrap();
        let urdf = urdf_rs::read_from_string(&text).unwrap();
        for q in poses(robot.joints.len(), 200) {
            let given = point(&pose(&urdf, base, "truearm_target", &q));
            let off = (given - identified_point(&model, &q)).norm();
            assert!(off < 1e-9, "{name}: {off:e}");
        }
        let original = std::fs::read_to_string(&path).unwrap();
        let before: Vec<&str> = original.lines().skip(1).collect();
        let changed = before.iter().zip(text.lines()).filter(|(a, b)| *a != b);
        let changed: Vec<_> = changed.map(|(a, _)| a.trim()).collect();
        assert_eq!(changed.len(), robot.joints.len() + 1, "{name}: {changed:?}");
        let mut origins = changed.iter().take(robot.joints.len());
        assert!(origins.all(|line| line.starts_with("<origin")), "{name}: {changed:?}");
        assert!(!changed.iter().any(|line| line.contains("9 9 9")), "a transmission's joint");
        // With nothing identified nothing moves.
        let still = Model {
            corrections: vec![MdhParameters::default(); robot.joints.len()],
            frame_translation: Vector3::zeros(),
            frame_rotation: Vector3::zeros(),
            ..model
        };
        let arm = Identified::of(&still, None).unwrap();
        let text = calibrated_like(&document, &ends, &still, &arm).unwrap();
        let (same, given) =
            (urdf_rs::read_from_string(&text).unwrap(), urdf_rs::read_file(&path).unwrap());
        for q in poses(robot.joints.len(), 20) {
            assert!(apart(&pose(&same, base, tip, &q), &pose(&given, base, tip, &q)) < 1e-9);
        }
    }
}

#[test]
fn a_urdf_of_another_arm_is_refused() {
    let document =
        |name: &str| Document::read(&data(&format!("tests/data/urdf/{name}.urdf"))).unwrap();
    let model = identified(&preset("ur5e"), 1);
    let arm = Identified::of(&model, None).unwrap();
    for (name, tip, says) in [
        ("panda", "panda_link8", "7 joints move in it, 6 in the model"),
        ("irb120", "tool0", "joint \"joint_2\" has its axis 127.500 mm and 180.0000 degrees from"),
        (
            "ur5e",
            "tool0",
            "joint \"shoulder_lift_joint\" has its axis 0.000 mm and 180.0000 degrees from",
        ),
    ] {
        let ends = Ends { base: None, tip: Some(tip.to_owned()) };
        let error = calibrated_like(&document(name), &ends, &model, &arm).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    }
}

/// The numbers of the published kinematics file come out of the preset.
#[test]
fn ur_calibration_files() {
    let still = |robot: &Robot| Model {
        corrections: vec![MdhParameters::default(); robot.joints.len()],
        frame_translation: Vector3::zeros(),
        frame_rotation: Vector3::zeros(),
        ..identified(robot, 1)
    };
    let robot = preset("ur10e");
    let arm = Identified::of(&still(&robot), None).unwrap();
    let entries = |text: &str| -> Vec<[f64; 6]> {
        let values = text.lines().filter_map(|line| line.split_once(": "));
        let values: Vec<f64> = values.filter_map(|(_, value)| value.parse().ok()).collect();
        values.chunks(6).map(|six| six.try_into().unwrap()).collect()
    };
    let text = ur_calibration(&robot, &arm, Some("calib_12788084448423163542")).unwrap();
    assert!(text.ends_with("  hash: calib_12788084448423163542\n"), "{text}");
    let quarter = std::f64::consts::FRAC_PI_2;
    let published = [
        [0.0, 0.0, 0.1807, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, quarter, 0.0, 0.0],
        [-0.6127, 0.0, 0.0, 0.0, 0.0, 0.0],
        [-0.57155, 0.0, 0.17415, 0.0, 0.0, 0.0],
        [0.0, -0.11985, 0.0, quarter, 0.0, 0.0],
        [0.0, 0.11655, 0.0, -quarter, 0.0, 0.0],
    ];
    for (a, b) in entries(&text).iter().zip(published) {
        assert!((0..6).all(|k| (a[k] - b[k]).abs() < 1e-12), "{a:?} {b:?}");
    }
    // Of an identified arm: as the driver's description multiplies them.
    let model = identified(&robot, 3);
    let arm = Identified::of(&model, None).unwrap();
    let text = ur_calibration(&robot, &arm, None).unwrap();
    assert!(text.contains("hash: calib_not_of_a_controller"), "{text}");
    let names = ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"];
    assert!(names.iter().all(|name| text.contains(&format!("  {name}:\n    x: "))), "{text}");
    for q in poses(6, 200) {
        let mut at = Matrix4::identity();
        for ([x, y, z, roll, pitch, yaw], q) in entries(&text).into_iter().zip(&q) {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), *q).to_homogeneous();
            at *= frame([x, y, z], [roll, pitch, yaw]) * turn;
        }
        let tip = arm.tip().translation;
        let given = (at * tip.push(1.0)).xyz();
        assert!((given - identified_point(&model, &q)).norm() < 1e-9);
    }
    for (name, says) in [
        ("panda", "7 joints where a UR has 6"),
        ("irb-120", "joint 2 has alpha_deg = -90.000 where a UR has 90"),
    ] {
        let robot = preset(name);
        let model = still(&robot);
        let arm = Identified::of(&model, None).unwrap();
        let error = ur_calibration(&robot, &arm, None).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    }
}

/// The tables, read again and multiplied as their conventions say.
#[test]
fn tables_are_the_identified_arm() {
    for (k, name) in
        ["ur10", "panda", "xarm6", "gen3", "kr-6-r900", "puma-560"].into_iter().enumerate()
    {
        let model = identified(&preset(name), 20 + k as u64);
        let arm = Identified::of(&model, None).unwrap();
        let path = Path::new("table.csv");
        let read = |text: &str, convention| {
            Table::parse(path, text, convention, &Units::default()).unwrap()
        };
        let mdh = read(&mdh_csv(&arm), Convention::Modified);
        let dh = standard_dh(&model, &arm);
        let standard = read(&standard_dh_csv(&dh), Convention::Standard);
        // Neighbours of URs are so nearly parallel that the normal is 9 m and more away.
        let exact = dh.described.straightened.is_empty();
        assert_eq!(exact, !matches!(name, "ur10" | "xarm6" | "kr-6-r900" | "puma-560"), "{name}");
        let most = if exact { 1e-9 } else { dh.deviation * 1.5 };
        assert!(exact || (1e-5..5e-3).contains(&dh.deviation), "{name}: {}", dh.deviation);
        for q in poses(model.robot.joints.len(), 200) {
            let real = identified_point(&model, &q);
            let given = arm.base.compose(&mdh.pose(&q)).compose(&arm.tool).translation;
            assert!((given - real).norm() < 1e-9, "{name}");
            let (base, tool) = (dh.described.base, dh.described.tool);
            let given = base.compose(&standard.pose(&q)).compose(&tool).translation;
            assert!((given - real).norm() < most, "{name}: {:e}", (given - real).norm());
        }
    }
}

#[test]
fn what_is_left_out_has_a_size() {
    let mut model = identified(&preset("ur10"), 1);
    assert!(left_out(&model).is_empty());
    let term = truearm::effects::Term {
        effect: truearm::effects::Effect::JointGain,
        joint: 1,
        source: 0,
        component: 0,
        order: 0.0,
        coefficient: 1e-3,
    };
    model.terms = vec![ModelTerm::Arm(term)];
    let sizes = left_out(&model);
    // A gain of 1e-3 over 1.5 rad of an arm of some 1.3 m and its target.
    assert_eq!((sizes[0].effect, sizes[0].joints.as_slice()), ("joint-gain", &[2][..]));
    assert!((1e-4..2.4e-3).contains(&sizes[0].largest) && sizes[0].rms < sizes[0].largest);
    assert_eq!((sizes.len(), sizes[1].effect), (2, ""));
}

#[test]
fn tables_of_users() {
    let units = Units { length: Some(1.0), angle: Some(1.0) };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ur10.csv");
    // As a data sheet has it: radians, metres, pi/2.
    for text in [
        "theta,a,d,alpha\n0,0,0.1273,pi/2\n0,-0.612,0,0\n0,-0.5723,0,0\n0,0,0.163941,pi/2\n0,0,0.1157,-pi/2\n0,0,0.0922,0\n",
        "Joint;θ [rad];a [m];d [m];α [rad]\n1;0;0;0,1273;π/2\n2;0;-0,612;0;0\n3;0;-0,5723;0;0\n4;0;0;0,163941;π/2\n5;0;0;0,1157;-π/2\n6;0;0;0,0922;0\n",
    ] {
        std::fs::write(&file, text).unwrap();
        let text = robot_of_table(&file, Convention::Standard, &units).unwrap();
        let (made, given) = (Robot::parse(&file, &text).unwrap(), preset("ur10"));
        for q in poses(6, 50) {
            let (a, b) = (made.nominal_target()(&q), given.nominal_target()(&q));
            assert!((a.translation - b.translation).norm() < 1e-12);
        }
    }
}

#[test]
fn bad_tables() {
    let none = Units::default();
    let titles = "alpha_deg,a_mm,theta_offset_deg,d_mm\n";
    let with = |row: &str| format!("{titles}{row}\n");
    for (text, convention, says) in [
        (String::new(), Convention::Modified, "t.csv:1: no column for alpha"),
        (titles.to_owned(), Convention::Modified, "t.csv: no joints in the table"),
        (
            with("0,0,0"),
            Convention::Modified,
            "CSV error: record 1 (line: 2, byte: 37): found record with 3 fields",
        ),
        (
            with("0,0,q1,0"),
            Convention::Modified,
            "t.csv:2, column theta_offset_deg: \"q1\" is not a number -> give a number",
        ),
        (with("0,,0,0"), Convention::Modified, "t.csv:2, column a_mm: \"\" is not a number"),
        (with("0,inf,0,0"), Convention::Modified, "t.csv:2, column a_mm: \"inf\" is not a number"),
        (
            "alpha,a,theta,d\n0,0,0,0\n".to_owned(),
            Convention::Modified,
            "column \"alpha\" does not say its unit -> write it into the title, as in alpha_deg or alpha_rad, or give --angles deg|rad",
        ),
        (
            "alpha_deg,a,theta_deg,d_m\n0,0,0,0\n".to_owned(),
            Convention::Modified,
            "column \"a\" does not say its unit -> write it into the title, as in a_mm or a_m, or give --lengths mm|m",
        ),
        (
            "alpha_deg,a_mm,d_mm\n0,0,0\n".to_owned(),
            Convention::Modified,
            "no column for theta_offset among alpha_deg, a_mm, d_mm",
        ),
        (
            "alpha_deg,a_mm,a_m,theta_deg,d_mm\n0,0,0,0,0\n".to_owned(),
            Convention::Modified,
            "two columns for a -> delete one",
        ),
        (
            "alpha_deg,a_mm,theta_deg,d_mm,mass\n0,0,0,0,0\n".to_owned(),
            Convention::Modified,
            "column \"mass\" is not known",
        ),
        (
            "alpha_deg,a_mm,theta_deg,d_mm,beta_deg\n0,0,0,0,0\n".to_owned(),
            Convention::Standard,
            "a column for beta in a standard table",
        ),
        (
            "alpha_deg,a_mm,theta_deg,d_mm,kind\n0,0,0,0,x\n".to_owned(),
            Convention::Standard,
            "t.csv:2, column kind: \"x\" -> use revolute or prismatic",
        ),
        (
            "alpha_deg,a_mm,theta_deg,d_mm,lower_deg,upper_deg\n0,0,0,0,5,-5\n".to_owned(),
            Convention::Standard,
            "t.csv:2: limits from",
        ),
    ] {
        let error = Table::parse(Path::new("t.csv"), &text, convention, &none).unwrap_err();
        let message = format!("{error} -> {}", error.help());
        assert!(message.contains(says), "{message}\nshould say\n{says}");
    }
}

/// Runs the program in a folder: exit status, standard output and error.
fn truearm(folder: &Path, line: &str) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    let ran = command.current_dir(folder).args(line.split(' ')).output().unwrap();
    let text = |bytes: &[u8]| {
        let words = String::from_utf8_lossy(bytes).into_owned();
        words.split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ")
    };
    (ran.status.code().unwrap(), text(&ran.stdout), text(&ran.stderr))
}

#[test]
fn from_a_data_sheet_to_a_calibrated_urdf() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let seed = data("../tests/data/seed-table-8");
    std::fs::copy(seed.join("measurements.csv"), at.join("measurements.csv")).unwrap();
    std::fs::copy(seed.join("robot.toml"), at.join("mine.toml")).unwrap();
    std::fs::copy(data("tests/data/urdf/ur5e.urdf"), at.join("ur5e.urdf")).unwrap();
    for (line, status, says) in [
        ("robot", 2, "required arguments were not provided"),
        ("robot --init --list", 2, "cannot be used with"),
        ("robot --list", 0, "irb-120 ABB IRB 120-3/0.6: ABB, \"Product specification"),
        ("robot --preset ur1", 2, "a similar value exists: 'ur10'"),
        (
            "robot --init --out mine.toml",
            1,
            "mine.toml: the file is there, and it is not as truearm wrote it",
        ),
        ("robot --init --tip-link a", 2, "cannot be used with"),
        ("robot --preset ur5 --lengths m", 2, "cannot be used with"),
        ("robot --dh craig table.csv", 2, "say the convention, then the file"),
        ("robot --dh standard table.csv", 1, "table.csv"),
        ("robot --urdf ur5e.urdf", 0, "[[joints]]"),
        ("robot --urdf ur5e.urdf --tip-link tool0 --out robot.toml", 0, "q3 elbow_joint"),
        ("robot --preset UR10 --out robot.toml", 0, "wrote robot.toml"),
        ("identify mine.toml measurements.csv --out .", 0, ""),
        ("export model.toml", 2, "required arguments were not provided"),
        (
            "export model.toml --urdf out.urdf --marker x",
            2,
            "--marker x: the model does not have it",
        ),
        ("export model.toml --urdf ur5e.urdf", 1, "ur5e.urdf: the file is there"),
        (
            "export model.toml --urdf out.urdf --mdh mdh.csv --dh dh.csv --json out.json",
            0,
            "wrote out.urdf wrote mdh.csv wrote dh.csv wrote out.json",
        ),
        ("export model.toml --urdf out.urdf", 0, "wrote out.urdf"),
        ("export model.toml --ur-calibration ur.yaml --ur-hash a:b", 2, "--ur-hash a:b"),
        ("robot --dh modified mdh.csv", 0, "[[joints]]"),
        ("robot --dh modified mdh.csv", 0, "write it under [tool]: xyz_mm"),
        ("robot --urdf out.urdf", 0, "name ="),
    ] {
        let (code, out, err) = truearm(at, line);
        let said = format!("{out} {err}");
        assert_eq!(code, status, "{line}: {said}");
        assert!(said.contains(says), "{line}: {said}\nshould say {says}");
    }
    // What was edited since is kept.
    let path = at.join("robot.toml");
    let edited = std::fs::read_to_string(&path).unwrap() + "\n";
    std::fs::write(&path, &edited).unwrap();
    assert_eq!(truearm(at, "robot --preset ur5 --out robot.toml").0, 1);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), edited);
    assert_eq!(truearm(at, "robot --preset ur5 --out robot.toml --force").0, 0);
}
