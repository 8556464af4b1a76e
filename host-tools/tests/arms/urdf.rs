//! URDF to robot.toml: the arm that comes out is the arm that went in.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use crate::plain_chain::{apart, frame, moves, path, pose};
use nalgebra::Matrix4;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::Pose;
use truearm_host::convert::urdf::{Document, Ends, Serial, robot_of_urdf};
use truearm_host::model::Robot;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/urdf/{name}.urdf"))
}

/// File, base, tip, moving joints: two of seven axes, three with axes along x,
/// y and their negatives, one with a joint that slides.
const ARMS: [(&str, &str, &str, usize); 8] = [
    ("ur5e", "base", "tool0", 6),
    ("panda", "panda_link0", "panda_link8", 7),
    ("iiwa14", "world", "ee", 7),
    ("kr6_r900", "link_0", "tool0", 6),
    ("irb120", "link_0", "tool0", 6),
    ("irb910sc", "link_0", "link_4", 4),
    ("xarm6", "link0", "link6", 6),
    ("puma560", "l0", "l6", 6),
];

fn ends(base: &str, tip: &str) -> Ends {
    Ends { base: Some(base.to_owned()), tip: Some(tip.to_owned()) }
}

fn matrix(pose: &Pose<f64>) -> Matrix4<f64> {
    let mut out = Matrix4::identity();
    out.fixed_view_mut::<3, 3>(0, 0).copy_from(&pose.rotation);
    out.fixed_view_mut::<3, 1>(0, 3).copy_from(&pose.translation);
    out
}

/// Largest difference over so many poses, beside that at zero.
fn worst(robot: &Robot, urdf: &urdf_rs::Robot, base: &str, tip: &str, poses: usize) -> f64 {
    let target = robot.nominal_target();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut worst = 0.0_f64;
    for k in 0..=poses {
        let q: Vec<f64> = robot
            .joints
            .iter()
            .map(|_| if k == 0 { 0.0 } else { rng.random_range(-4.0..4.0) })
            .collect();
        worst = worst.max(apart(&matrix(&target(&q)), &pose(urdf, base, tip, &q)));
    }
    worst
}

#[test]
fn published_arms() {
    for (name, base, tip, joints) in ARMS {
        let urdf = urdf_rs::read_file(data(name)).unwrap();
        // The UR's links `base` and `base_link` are both fixed to its first joint.
        let base = if name == "ur5e" { "base_link" } else { base };
        let made = robot_of_urdf(&data(name), &ends(base, tip)).unwrap();
        let robot = Robot::parse(Path::new("robot.toml"), &made.text).unwrap();
        assert_eq!(robot.joints.len(), joints, "{name}");
        let worst = worst(&robot, &urdf, base, tip, 1000);
        assert!(worst < 1e-9, "{name}: {worst:e}");
        // No cry of alarm at rounding; that no tracker is known is no fault.
        assert_eq!(robot.warnings.len(), 1, "{name}: {:?}", robot.warnings);
        let limits = path(&urdf, base, tip)
            .into_iter()
            .filter(|j| moves(j))
            .map(|j| (j.limit.lower != j.limit.upper).then_some([j.limit.lower, j.limit.upper]));
        for (joint, limits) in robot.joints.iter().zip(limits) {
            match (joint.limits, limits) {
                (Some(a), Some(b)) => assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-12)),
                (a, b) => assert_eq!(a, b, "{name}"),
            }
        }
    }
}

/// The numbers of a drawing come out as the drawing has them.
#[test]
fn parameters_are_plain() {
    let made = robot_of_urdf(&data("panda"), &ends("panda_link0", "panda_link8")).unwrap();
    let robot = Robot::parse(Path::new("robot.toml"), &made.text).unwrap();
    let d: Vec<f64> = robot.joints.iter().map(|j| j.link.parameters.d).collect();
    assert_eq!(d, [0.333, 0.0, 0.316, 0.0, 0.384, 0.0, 0.107]);
    let a: Vec<f64> = robot.joints.iter().map(|j| j.link.parameters.a).collect();
    assert_eq!(a, [0.0, 0.0, 0.0, 0.0825, -0.0825, 0.0, 0.088]);
    assert!(!made.text.contains("[base]") && !made.text.contains("[tool]"), "{}", made.text);
    let made = robot_of_urdf(&data("ur5e"), &ends("base_link", "tool0")).unwrap();
    // Parallel axes carry no d and no beta.
    assert!(made.text.contains("a_mm = 425.0\n"), "{}", made.text);
    assert!(!made.text.contains("beta_deg"), "{}", made.text);
}

/// A mass that no body has is named, and gravity is not taken from the rest.
#[test]
fn impossible_masses() {
    let text = std::fs::read_to_string(data("ur5e")).unwrap();
    for mass in ["-2.846", "nan"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("arm.urdf");
        let changed = text.replacen("2.846", mass, 1);
        assert_ne!(text, changed);
        std::fs::write(&path, changed).unwrap();
        let made = robot_of_urdf(&path, &ends("base_link", "tool0")).unwrap();
        let says = made.warnings.join(" ");
        assert!(says.contains("forearm_link has"), "{mass}: {says}");
        assert!(!made.text.contains("[[links]]"), "{mass}");
    }
}

/// Masses and centres of what hangs on a joint, fixed parts included: the first
/// moment of the whole arm in the base is that of the URDF's own links.
#[test]
fn masses() {
    let urdf = urdf_rs::read_file(data("ur5e")).unwrap();
    let made = robot_of_urdf(&data("ur5e"), &ends("base_link", "tool0")).unwrap();
    let robot = Robot::parse(Path::new("robot.toml"), &made.text).unwrap();
    let total: f64 = robot.links.iter().map(|l| l.mass).sum();
    assert!((total - (3.761 + 8.058 + 2.846 + 1.37 + 1.3 + 0.365)).abs() < 1e-12);
    assert_eq!(robot.gravity.map(|g| g.z), Some(-9.80665));
    let links = ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"];
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..50 {
        let q: Vec<f64> = (0..6).map(|_| rng.random_range(-3.0..3.0)).collect();
        for (i, link) in links.iter().enumerate() {
            let name = format!("{link}_link");
            let com = urdf.links.iter().find(|l| l.name == name).unwrap().inertial.origin.xyz;
            let given = pose(&urdf, "base_link", &name, &q[..=i]) * frame(*com, [0.0; 3]);
            // The frame of link i is the target of an arm that ends there.
            let mut part = robot.clone();
            part.joints.truncate(i + 1);
            part.tool = robot.links[i].com;
            part.tool_rpy = nalgebra::Vector3::zeros();
            let made = part.nominal_target()(&q[..=i]).translation;
            let given = given.fixed_view::<3, 1>(0, 3).into_owned();
            assert!((made - given).norm() < 1e-9, "{name}: {made} {given}");
        }
    }
}

/// An origin or turn of a random URDF.
fn three(choice: u8, random: [f64; 3], scale: f64, step: f64) -> [f64; 3] {
    match choice {
        0 => [0.0; 3],
        1 => [0.0, 0.0, (random[2] / step).round() * step],
        2 => [(random[0] / step).round() * step, 0.0, 0.0],
        3 => random.map(|x| (x / step).round() * step),
        // Almost what a drawing has.
        4 => random.map(|x| (x / step).round() * step + x * 1e-6),
        5 => random.map(|x| (x / step).round() * step + x * 1e-11),
        _ => random.map(|x| x * scale),
    }
}

prop_compose! {
    fn any_joint()(
        kind in 0..4_u8, axis in 0..8_u8, random in prop::array::uniform9(-1.0..1.0_f64),
        place in 0..7_u8, turn in 0..7_u8,
    ) -> (u8, [f64; 3], [f64; 3], [f64; 3]) {
        let r = |k: usize| [random[k], random[k + 1], random[k + 2]];
        let axis = match axis {
            0 | 1 => [0.0, 0.0, 1.0],
            2 => [0.0, 0.0, -1.0],
            3 => [0.0, 1.0, 0.0],
            4 => [-1.0, 0.0, 0.0],
            5 => [1e-7, 0.0, 2.0],
            // Long enough to have a direction.
            _ => r(0).map(|x| x + 0.1 * x.signum()),
        };
        let xyz = three(place, r(3), 1.0, 0.1);
        let rpy = three(turn, r(6).map(|x| x * 3.2), 1.0, FRAC_PI_2);
        (kind, axis, xyz, rpy)
    }
}

/// Kind, axis, translation and rotation of a joint's origin.
type AnyJoint = (u8, [f64; 3], [f64; 3], [f64; 3]);

fn text_of(joints: &[AnyJoint]) -> String {
    let three = |v: &[f64; 3]| format!("{:?} {:?} {:?}", v[0], v[1], v[2]);
    let mut text = String::from("<robot name=\"random\"><link name=\"l0\"/>");
    for (i, (kind, axis, xyz, rpy)) in joints.iter().enumerate() {
        let kind = ["revolute", "continuous", "prismatic", "fixed"][usize::from(*kind)];
        text += &format!(
            "<link name=\"l{}\"/><joint name=\"j{i}\" type=\"{kind}\"><origin xyz=\"{}\" rpy=\"{}\"/>\
             <parent link=\"l{i}\"/><child link=\"l{}\"/><axis xyz=\"{}\"/></joint>",
            i + 1,
            three(xyz),
            three(rpy),
            i + 1,
            three(axis)
        );
    }
    text + "</robot>"
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn any_chain(joints in prop::collection::vec(any_joint(), 1..9)) {
        prop_assume!(joints.iter().any(|joint| joint.0 < 3));
        any_chain_holds(&joints)?;
    }
}

/// The robot.toml of this chain is the chain.
fn any_chain_holds(joints: &[AnyJoint]) -> Result<(), TestCaseError> {
    let text = text_of(joints);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("random.urdf");
    std::fs::write(&file, &text).unwrap();
    let made = robot_of_urdf(&file, &Ends::default());
    let made = made.map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
    let robot = Robot::parse(Path::new("robot.toml"), &made.text).unwrap();
    let urdf = urdf_rs::read_from_string(&text).unwrap();
    let tip = format!("l{}", joints.len());
    let worst = worst(&robot, &urdf, "l0", &tip, 20);
    prop_assert!(worst < 1e-9, "{worst:e}\n{text}\n{}", made.text);
    Ok(())
}

/// Axes six degrees from parallel have their common normal ten metres off, which
/// a robot.toml has no room for: on the first axis, or only on the second.
#[test]
fn almost_parallel_axes() {
    let along_x: [f64; 3] = [-1.0, 0.0, 0.0];
    let tilted = [-1.5147728112491161, 0.8322021984982977, 1.4960028163732484];
    for (turn, place) in [
        (tilted, [1.0, -1.0, -0.9]),
        (tilted, [1.0, -1.0, 0.9]),
        ([0.1, FRAC_PI_2, 0.0], [0.0, 1.0, 1.0]),
        ([0.1, -FRAC_PI_2, 0.0], [-1.0, 0.95, 1.0]),
    ] {
        let joints = [(0, along_x, [0.5, 0.0, 0.0], [0.0; 3]), (0, [0.0, 0.0, 1.0], place, turn)];
        any_chain_holds(&joints).unwrap();
    }
}

/// Axes across each other have their common normal wherever it is, far out as well.
#[test]
fn far_out_across() {
    let (z, y) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    for (kind, place) in [(0, [0.0, 4.6, 0.0]), (2, [0.0, -7.0, 0.0]), (0, [0.5, 6.0, 8.0])] {
        let joints = [(0, z, [0.0; 3], [0.0; 3]), (kind, y, place, [0.0; 3])];
        any_chain_holds(&joints).unwrap();
        let slides =
            [(2, z, [0.0; 3], [0.0; 3]), (kind, y, place, [0.0; 3]), (0, z, [0.1; 3], [0.0; 3])];
        any_chain_holds(&slides).unwrap();
    }
}

/// A robot of one joint with this in it.
fn with(element: &str, joint: &str) -> String {
    format!(
        "<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"b\"/>\n{element}\n<joint name=\"j1\" \
         {joint}\n<parent link=\"a\"/><child link=\"b\"/>\n</joint>\n</robot>\n"
    )
}

const TURNS: &str =
    "type=\"revolute\"><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\"/>";

fn another(kind: &str, parent: &str, child: &str) -> String {
    format!(
        "<link name=\"{child}\"/>\n<joint name=\"{child}_joint\" type=\"{kind}\"><parent link=\"{parent}\"/>\
         <child link=\"{child}\"/><axis xyz=\"0 0 1\"/></joint>"
    )
}

#[test]
fn refusals() {
    let none = Ends::default();
    let many: String =
        (1..20).map(|i| another("continuous", &format!("k{}", i - 1), &format!("k{i}"))).collect();
    let many = format!("<robot name=\"r\"><link name=\"k0\"/>{many}</robot>");
    let tip = |tip: &str| Ends { base: None, tip: Some(tip.to_owned()) };
    let base = |base: &str| Ends { base: Some(base.to_owned()), tip: None };
    for (text, ends, says) in [
        (String::new(), &none, "no <robot> in it -> give a URDF"),
        ("<robot".to_owned(), &none, "not a URDF: "),
        ("<sdf version=\"1.6\"></sdf>".to_owned(), &none, "this is SDF, not URDF"),
        ("<mujoco model=\"a\"/>".to_owned(), &none, "this is MuJoCo's MJCF, not URDF"),
        (
            with("<xacro:include filename=\"x\"/>", TURNS),
            &none,
            "this is xacro, from which a URDF is made -> expand it: `xacro FILE > robot.urdf`",
        ),
        (with("", "type=\"revolute\"><origin xyz=\"0 0 ${d}\"/>"), &none, "this is xacro"),
        (with("", "type=\"turning\">"), &none, "not a URDF: "),
        (with("", "type=\"revolute\"><origin xyz=\"0 0\"/>"), &none, "Wrong vector element count"),
        (
            with("", "type=\"revolute\"><origin xyz=\"0 0 nan\"/>"),
            &none,
            "r.urdf:5:1: joint \"j1\" has NaN in its origin or axis",
        ),
        (
            with("", "type=\"revolute\"><origin xyz=\"0 0 340\"/>"),
            &none,
            "joint \"j1\" is 10 m or more from its parent -> URDF is in metres",
        ),
        (
            with("", "type=\"revolute\"><axis xyz=\"0 0 0\"/>"),
            &none,
            "joint \"j1\" has an axis without direction",
        ),
        (
            with("", &TURNS.replace("\"-1\"", "\"2\"")),
            &none,
            "joint \"j1\" has limits from 2 to 1 -> give the lower limit first",
        ),
        (
            with("", &TURNS.replace("\"-1\"", "\"NaN\"")),
            &none,
            "joint \"j1\" has a limit that is no number",
        ),
        (
            with("", &TURNS.replace("revolute", "fixed")),
            &none,
            "no joint moves between \"a\" and \"b\"",
        ),
        (
            with("", &TURNS.replace("revolute", "floating")),
            &none,
            "joint \"j1\" is floating: it has six values",
        ),
        (
            with("", &TURNS.replace("revolute", "planar")),
            &none,
            "joint \"j1\" is planar: it has three values",
        ),
        (
            with("", &format!("{TURNS}<mimic joint=\"j0\"/>")),
            &none,
            "joint \"j1\" mimics \"j0\": it has no value of its own",
        ),
        (with("<link name=\"b\"/>", TURNS), &none, "link \"b\" stands there twice"),
        (
            with(&another("fixed", "b", "c"), TURNS).replace("c_joint", "j1"),
            &none,
            "joint \"j1\" stands there twice",
        ),
        (
            with("", TURNS).replace("<child link=\"b\"", "<child link=\"z\""),
            &none,
            "joint \"j1\" leads to link \"z\", which is not there",
        ),
        (
            with(
                "<joint name=\"j2\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>",
                TURNS,
            ),
            &none,
            "both lead to link \"b\"",
        ),
        (
            with(
                "<joint name=\"j2\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint>",
                TURNS,
            ),
            &none,
            "every link hangs on another",
        ),
        (
            with("<link name=\"c\"/>", TURNS),
            &none,
            "2 links hang on nothing: a, c -> say which it is: --base-link LINK",
        ),
        (
            with(&another("continuous", "a", "c"), TURNS),
            &none,
            "several chains, which end at b (1 joints), c (1 joints) -> say which: --tip-link LINK",
        ),
        (
            with(&(another("fixed", "b", "c") + &another("fixed", "b", "d")), TURNS),
            &none,
            "2 links end the chain: c, d -> say where",
        ),
        (with("", TURNS), &tip("z"), "no link \"z\", given as --tip-link -> its links are a, b"),
        (with("", TURNS), &base("z"), "no link \"z\", given as --base-link -> its links are a, b"),
        (
            with("<link name=\"c\"/>", TURNS),
            &Ends { base: Some("c".into()), tip: Some("b".into()) },
            "link \"b\" does not hang on \"c\"",
        ),
        (
            with("", TURNS),
            &Ends { base: Some("b".into()), tip: Some("b".into()) },
            "no joint moves between \"b\" and \"b\"",
        ),
        (many, &none, "19 joints move between \"k0\" and \"k19\" -> truearm handles up to 16"),
    ] {
        let error = Document::parse(Path::new("r.urdf"), text.clone())
            .and_then(|document| Serial::of(&document, ends));
        let error = error.map(|_| ()).expect_err(&text);
        let message = format!("{error} -> {}", error.help());
        assert!(message.contains(says), "{message}\nshould say\n{says}");
    }
}

#[test]
fn an_expanded_file_may_talk_of_xacro() {
    let text = with("<!-- made of ${arm} by <xacro:arm/>, $(find x) -->", TURNS);
    let document = Document::parse(Path::new("r.urdf"), text).unwrap();
    assert_eq!(Serial::of(&document, &Ends::default()).unwrap().joints.len(), 1);
}

#[test]
fn a_hand_needs_a_tip() {
    let error = robot_of_urdf(&data("panda"), &Ends::default()).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains("panda_leftfinger (8 joints), panda_rightfinger (8 joints)"),
        "{message}"
    );
}

/// Numbers that are angles of no arm in radians.
#[test]
fn degrees_are_refused() {
    let arm = include_str!("../data/urdf/ur5e.urdf");
    let read = |text: String| Document::parse(Path::new("arm.urdf"), text);
    read(arm.to_owned()).unwrap();
    let turned = arm.replacen("rpy=\"1.570796327 0 0\"", "rpy=\"0 90 0\"", 1);
    let limit = arm.find("upper=\"").unwrap();
    let end = limit + 7 + arm[limit + 7..].find('"').unwrap();
    let wide = format!("{}upper=\"170{}", &arm[..limit], &arm[end..]);
    for (text, angle) in [(turned, 90), (wide, 170)] {
        let error = read(text).expect_err("degrees");
        let said = format!("{error} -> {}", error.help());
        assert!(said.contains(&format!("an angle of {angle} in its rpy or")), "{said}");
        assert!(said.contains("radians"), "{said}");
    }
}

/// What reads XML goes down with every element, and has a stack.
#[test]
fn elements_without_end_within_each_other_are_refused() {
    let deep = |depth: usize| {
        let (open, close) = ("<link>\n".repeat(depth), "</link>\n".repeat(depth));
        let text = format!("<robot name=\"deep\">\n{open}{close}</robot>\n");
        Document::parse(Path::new("deep.urdf"), text).unwrap_err().to_string()
    };
    let message = deep(40_000);
    assert!(message.contains("deep.urdf:101") && message.contains("100 deep"), "{message}");
    assert!(!deep(99).contains("100 deep"));
}
