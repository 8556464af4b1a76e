//! Poses planned for each kind: they are feasible, what is predicted of the tool is what
//! simulated arms have that were measured there, and as many random ones are worse.

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use crate::judged::{Judged, SIGMAS, cell, most_probable, robot};
use nalgebra::{Rotation3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm_host::files::{Gathered, planned_csv};
use truearm_host::identify::{Problem, Scaling};
use truearm_host::model::{Form, Measurements, Robot, Workspace};
use truearm_host::observations::pixel::is_unfolded;
use truearm_host::observations::{KINDS, by_name};
use truearm_host::plan::cell::Cell as Around;
use truearm_host::plan::kinds::candidates;
use truearm_host::plan::{Candidate, PlanOptions, PosePlan, plan};
use truearm_simulate::instruments::{Cell, Sigmas};
use truearm_simulate::rigid;

/// Brown's polynomial with k1 alone turns back where 1 + 3 k1 r^2 is nothing.
#[test]
fn a_lens_ends_where_it_turns_back() {
    let text = "[[cameras]]\nlabel = \"c\"\nmounted = \"flange\"\nxyz_mm = [0, 0, 0]\n\
                rpy_deg = [0, 0, 0]\nfocal_px = [600, 600]\ncentre_px = [640, 512]\n\
                distortion = [-0.4, 0, 0, 0, 0]\n";
    let book = Gathered::parse(Path::new("instruments.toml"), text).unwrap();
    let camera = book.of(&[Form::Camera]).next().unwrap();
    let edge = 1.2_f64.sqrt().recip();
    for (r, shown) in [(0.0, true), (0.98 * edge, true), (1.02 * edge, false), (3.0, false)] {
        let point = Vector3::new(0.6 * r, -0.8 * r, 1.0) * 0.7;
        assert_eq!(is_unfolded(camera, &point), shown, "{r}");
    }
}

const ARMS: u64 = 12;
/// By how much places that are stated are off, m.
const OFF: f64 = 1e-3;

/// A cell, and what its user knows of it.
struct Bench {
    robot: Robot,
    cell: Cell,
    /// instruments.toml
    stated: String,
    workspace: Workspace,
}

/// What is changed of a cell, whether its places are guesses, which tables are stated.
struct Setting {
    change: fn(&mut Cell),
    guess: bool,
    keep: fn(&str) -> bool,
}

/// All of it guessed.
const ANY: Setting = Setting { change: |_| (), guess: true, keep: |_| true };
const ANCHORS: Setting = Setting { keep: |table| table.contains("\"A"), ..ANY };
const SEATS: Setting = Setting { keep: |table| table.contains("\"C"), guess: false, ..ANY };
const PLANES: Setting = Setting { keep: |table| table.contains("\"P"), ..ANY };
/// A camera that stands before the arm.
const EYE_TO_HAND: Setting = Setting {
    change: |cell| {
        cell.camera.in_hand = false;
        let turn = Vector3::new(0.0, -FRAC_PI_2, 0.0);
        cell.camera.place = rigid(&turn, &Vector3::new(3.5, 0.0, 0.4));
    },
    ..ANY
};

fn stated_robot() -> Robot {
    Robot { sigma: SIGMAS.length, sigma_angle: Some(SIGMAS.angle), ..robot() }
}

impl Bench {
    fn new(seed: u64, setting: &Setting) -> Self {
        let robot = stated_robot();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let cell = cell(&robot, &mut rng);
        Self::of(robot, cell, setting, &mut rng)
    }

    fn of(robot: Robot, mut cell: Cell, setting: &Setting, rng: &mut ChaCha8Rng) -> Self {
        let Setting { change, guess, keep } = setting;
        change(&mut cell);
        let all = cell.placed(if *guess { OFF } else { 0.0 }, *guess, rng);
        let tables = all.split("[[").skip(1).filter(|table| keep(table));
        let stated = tables.map(|table| format!("[[{table}")).collect();
        let workspace = Workspace::new(&robot, Some(vec![[-2.6, 2.6]; 6])).unwrap();
        Self { robot, cell, stated, workspace }
    }

    fn book(&self) -> Gathered {
        Gathered::parse(Path::new("instruments.toml"), &self.stated).unwrap()
    }

    fn options(&self, kind: &str, poses: usize) -> PlanOptions {
        PlanOptions {
            kind: by_name(kind).unwrap(),
            instruments: self.book(),
            poses,
            workspace: self.workspace.clone(),
            candidates: 600,
            target: None,
            seed: 5,
        }
    }

    fn planned(&self, kind: &str, poses: usize) -> PosePlan {
        plan(&self.robot, &self.options(kind, poses), &|_, _| ()).unwrap()
    }

    fn random(&self, kind: &str, poses: usize, seed: u64) -> Vec<Candidate> {
        let book = self.book();
        let around = Around::new(&self.robot, &self.workspace, &book);
        candidates(kind, &around, poses, seed).unwrap().0
    }

    /// Square of the error of the tool after these measurements of this arm, m^2.
    fn error(&self, kind: &str, measurements: &[Candidate], rng: &mut ChaCha8Rng) -> f64 {
        let of = KINDS[usize::from(by_name(kind).unwrap().0)];
        let file = planned_csv(&self.robot, of, measurements);
        let text = self.cell.filled(&file, rng);
        let data = Measurements::parse_with(Path::new("m.csv"), &text, &self.robot, &self.stated);
        let data = data.unwrap_or_else(|e| panic!("{e}"));
        let problem = Problem::new(&data, &self.robot, Scaling::Prior);
        let found = most_probable(&problem, &self.robot).unwrap_or_else(|e| panic!("{e}"));
        Judged::of(&problem, &self.cell, rng).error(&found.fit.state).powi(2)
    }
}

/// Root mean square errors over arms of a plan and of random measurements, beside what is
/// predicted of the plan. Where something stays open for which the tolerances stand, it
/// hides the difference, and what is predicted but for it is compared.
fn promise(kind: &str, poses: usize, setting: &Setting) {
    let each = |seed: u64| {
        let bench = Bench::new(900 + seed, setting);
        let planned = bench.planned(kind, poses);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let error = bench.error(kind, &planned.measurements, &mut rng);
        let random = bench.random(kind, poses, seed);
        let random = bench.error(kind, &random, &mut rng);
        let worst = planned.determined.map_or([0.0, 1.0], |d| [d.worst, d.random_worst]);
        let both = [planned.worst, planned.random_worst];
        assert!(both[0] <= both[1] * 1.001, "{kind}: {both:?} {worst:?}");
        assert!(worst[0] < worst[1], "{kind}: {worst:?}");
        ([planned.rms.powi(2), error, random], planned.determined.is_some())
    };
    let all: Vec<([f64; 3], bool)> = (0..ARMS).into_par_iter().map(each).collect();
    let mean = |k: usize| (all.iter().map(|x| x.0[k]).sum::<f64>() / ARMS as f64).sqrt();
    let [predicted, error, random] = [0, 1, 2].map(mean);
    println!(
        "{kind} {poses}: predicted {:.1}, simulated {:.1}, random {:.1} um",
        predicted * 1e6,
        error * 1e6,
        random * 1e6
    );
    assert!((0.75..1.3).contains(&(error / predicted)), "{kind}");
    assert!(all[0].1 || error < random, "{kind}");
}

#[test]
fn touches_keep_their_promise() {
    promise("touch", 60, &ANY);
    promise("touch", 60, &Setting { guess: false, ..ANY });
}

#[test]
fn holes_keep_their_promise() {
    promise("plate", 20, &ANY);
    promise("plate", 20, &Setting { guess: false, ..ANY });
}

#[test]
fn lengths_keep_their_promise() {
    promise("distance", 60, &ANCHORS);
    promise("distance", 60, &Setting { guess: false, ..ANCHORS });
    promise("pair", 50, &ANY);
}

#[test]
fn ranges_keep_their_promise() {
    promise("range", 70, &PLANES);
}

#[test]
fn images_keep_their_promise() {
    promise("pixel", 10, &ANY);
    promise("pixel", 40, &EYE_TO_HAND);
}

#[test]
fn inclinations_keep_their_promise() {
    promise("inclination", 25, &ANY);
}

#[test]
fn closures_keep_their_promise() {
    promise("closure", 24, &SEATS);
    promise("closure", 24, &Setting { guess: true, ..SEATS });
}

/// An arm as it is drawn comes to every planned pose and reads there what was planned: the
/// simulator has no line of the planner's geometry.
#[test]
fn planned_poses_are_feasible() {
    let nominal = |setting: &Setting| {
        let robot = stated_robot();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut cell = cell(&robot, &mut rng);
        cell.links = robot.nominal().iter().map(|link| link.parameters.to_array()).collect();
        cell.tool = robot.tool;
        cell.turn = Rotation3::identity();
        cell.sigmas = Sigmas { length: 1e-8, angle: 1e-7, pixel: 1e-3 };
        Bench::of(robot, cell, &Setting { guess: false, ..*setting }, &mut rng)
    };
    for (kind, setting) in [
        ("touch", &ANY),
        ("plate", &ANY),
        ("distance", &ANCHORS),
        ("pair", &ANY),
        ("range", &PLANES),
        ("pixel", &ANY),
        ("pixel", &EYE_TO_HAND),
        ("inclination", &ANY),
        ("closure", &SEATS),
    ] {
        let bench = nominal(setting);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let all = bench.random(kind, 200, 8);
        let rows: Vec<_> = all.iter().flatten().collect();
        assert_eq!(all.len(), 200, "{kind}");
        let of = KINDS[usize::from(by_name(kind).unwrap().0)];
        let file = planned_csv(&bench.robot, of, &all);
        let text = bench.cell.filled(&file, &mut rng);
        // No corner is lost, no joint moves by more than its last digit does.
        let data = Measurements::parse_with(Path::new("m.csv"), &text, &bench.robot, &bench.stated);
        let data = data.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(data.rows.len(), rows.len(), "{kind}");
        for (row, planned) in data.rows.iter().zip(&rows) {
            for (q, planned) in row.q.iter().zip(&planned.q) {
                // Nearly stretched arms follow the last digit with more.
                assert!((q - planned).abs() < 1e-4 && planned.abs() <= 2.6, "{kind} {q} {planned}");
            }
            let flange = bench.cell.flange(&row.q);
            let flange = Vector3::from_fn(|i, _| flange[i][3]);
            let target = bench.cell.target(&row.q);
            let label = |column: &str| {
                let label = planned.labels.iter().find(|(c, _)| *c == column);
                label.map_or("", |(_, label)| label.as_str())
            };
            match (kind, label("surface")) {
                ("touch", "ball") => {
                    let out = target - bench.cell.sphere.0;
                    assert!(out.dot(&(flange - target)) > 0.0);
                }
                ("touch", "pipe") => {}
                ("touch", _) => {
                    assert!(bench.cell.planes.iter().any(|(n, far)| {
                        (n.dot(&target) - far).abs() < 1e-7 && n.dot(&flange) > n.dot(&target)
                    }));
                }
                ("range", _) => assert!((0.05..2.0).contains(&row.measured[0])),
                ("distance", _) => assert!(row.measured[0] > 0.0),
                ("plate", _) => assert!(flange.z > target.z - 0.1),
                _ => {}
            }
        }
    }
}

/// A bar of one length, and a wire: no planned length is beyond.
#[test]
fn lengths_stay_within_reach() {
    let reach = |table: &str| table.contains("\"C0");
    let mut bench = Bench::new(1, &Setting { keep: reach, guess: false, ..ANY });
    bench.stated = bench.stated.replace("guess = false", "guess = true\nreach_mm = [299, 301]");
    let planned = bench.planned("distance", 40);
    let foot = bench.cell.anchors[0] * 0.5;
    for row in planned.measurements.iter().flatten() {
        let target = bench.robot.nominal_target()(&row.q).translation;
        assert!((0.2985..0.3015).contains(&(target - foot).norm()));
    }
}

#[test]
fn what_stays_open_is_said() {
    let bench = Bench::new(2, &PLANES);
    let planned = bench.planned("touch", 60);
    let determined = planned.determined.unwrap();
    assert!(planned.undetermined[0].contains("the overall scale"), "{:?}", planned.undetermined);
    assert!(determined.worst < 0.5 * planned.worst);
    let bench = Bench::new(2, &ANY);
    // No reading has a length in it: one that is known would close no other.
    let planned = bench.planned("inclination", 20);
    let [leaves] = &planned.undetermined[..] else { panic!("{:?}", planned.undetermined) };
    assert!(leaves.contains("every length"));
    let planned = bench.planned("plate", 20);
    assert!(planned.undetermined.is_empty() && planned.determined.is_none());
    assert_eq!(bench.planned("pixel", 10).what, "the camera");
    assert_eq!(bench.planned("range", 60).what, "the origin of the ray");
}

#[test]
fn what_cannot_be_measured_is_said() {
    let bench = Bench::new(3, &ANY);
    let plan_with = |kind: &str, stated: &str| {
        let book = Gathered::parse(Path::new("instruments.toml"), stated).unwrap();
        let options = PlanOptions { instruments: book, ..bench.options(kind, 20) };
        plan(&bench.robot, &options, &|_, _| ()).map(|_| ()).unwrap_err()
    };
    let holes = "holes = { A = [0, 0, 0] }";
    let camera = "[[cameras]]\nlabel = \"c\"\nfocal_px = [900, 900]\ncentre_px = [640, 512]\n";
    for (kind, stated, says, help) in [
        ("touch", String::new(), "no surface to touch", "[[surfaces]]"),
        ("plate", String::new(), "no plate that stands still", "[[plates]]"),
        ("distance", String::new(), "no point to measure from", "[[anchors]]"),
        ("range", String::new(), "no plane to range to", "[[surfaces]]"),
        ("pixel", String::new(), "no camera", "[[cameras]]"),
        ("closure", String::new(), "no point to come back to", "[[anchors]]"),
        (
            "touch",
            "[[surfaces]]\nlabel = \"t\"\n".to_owned(),
            "has no place",
            "point_mm and normal",
        ),
        ("plate", format!("[[plates]]\nlabel = \"p\"\n{holes}\n"), "has no place", "xyz_mm"),
        (
            "plate",
            format!(
                "[[plates]]\nlabel = \"p\"\nxyz_mm = [9000, 0, 0]\nrpy_deg = [0, 0, 0]\n{holes}\n"
            ),
            "leads to hole \"A\" of plate \"p\"",
            "--limits",
        ),
        ("pixel", camera.to_owned(), "has no place", "xyz_mm and rpy_deg"),
        (
            "pixel",
            format!("{camera}mounted = \"fixed\"\nxyz_mm = [5000, 0, 0]\nrpy_deg = [0, 90, 0]\n"),
            "an image of the marker",
            "mm in the frame",
        ),
        (
            "distance",
            "[[anchors]]\nlabel = \"a\"\nxyz_mm = [9000, 0, 0]\nreach_mm = [10, 20]\n".to_owned(),
            "anchor \"a\" within its reach",
            "mm in the frame",
        ),
    ] {
        let error = plan_with(kind, &stated);
        assert!(error.to_string().contains(says), "{kind}: {error}");
        assert!(error.help().contains(help), "{kind}: {}", error.help());
    }
    let reach = "[[anchors]]\nlabel = \"a\"\nxyz_mm = [0, 0, 0]\nreach_mm = [20, 10]\n";
    let error = Gathered::parse(Path::new("instruments.toml"), reach).unwrap_err();
    assert!(error.to_string().contains("reach_mm"), "{error}");
}
