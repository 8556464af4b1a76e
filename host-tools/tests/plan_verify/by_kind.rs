//! Verification by every kind: each in its own unit, with what is not known of the places
//! that the model found.

use std::fs;
use std::process::Command;

use crate::judged::{SIGMAS, cell, read, robot};
use nalgebra::{DMatrix, DVector, Rotation3, UnitQuaternion};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;
use truearm_host::identify::{Options, identify};
use truearm_host::model::arm::{Kinematics, chain};
use truearm_host::model::{Commanded, Model};
use truearm_host::report::VerifyReport;
use truearm_host::verify::{Conformity, Tolerances, Verification, verify};
use truearm_simulate::instruments::Cell;

type Wanted = [(&'static str, usize)];

const TRAINED: &Wanted = &[
    ("pose", 40),
    ("touch", 90),
    ("distance", 60),
    ("plate", 30),
    ("range", 60),
    ("inclination", 30),
];

/// A cell, its folder, and the model that was identified there, as it was written.
struct Trained {
    cell: Cell,
    folder: tempfile::TempDir,
    model: Model,
    rng: ChaCha8Rng,
}

impl Trained {
    fn new(seed: u64, wanted: &Wanted) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let cell = cell(&robot(), &mut rng);
        let data = read(&robot(), &cell, &cell.file(wanted, &mut rng));
        let found = identify(&robot(), &data, &Options::default(), &|_, _| ()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.toml");
        fs::write(&path, found.model.to_toml()).unwrap();
        fs::write(folder.path().join("instruments.toml"), cell.stated(false)).unwrap();
        Self { model: Model::read(&path).unwrap(), cell, folder, rng }
    }

    /// Rows as they are measured of an arm that was told something else than where it went:
    /// with `on` what a controller that compensates poses had been told.
    fn verified(&mut self, wanted: &Wanted, on: bool) -> truearm_host::Result<Verification> {
        let text = self.cell.file(wanted, &mut self.rng);
        let mut lines = text.lines();
        let header = lines.next().unwrap().replace("q", "cmd").replace("cmdx", "qx");
        let header = header.replace("cmdy", "qy").replace("cmdz", "qz").replace("cmdw", "qw");
        let pair = header.split(',').position(|name| name == "pair").unwrap();
        let told = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            let q: Vec<f64> =
                cells[..6].iter().map(|c| c.parse::<f64>().unwrap().to_radians()).collect();
            let q = if on { self.told(&q) } else { Some(q) };
            let text = q.map(|q| {
                let all: Vec<String> =
                    q.iter().map(|q| format!("{:.10}", q.to_degrees())).collect();
                [all.join(","), cells[6..].join(",")].join(",")
            });
            (cells[pair].to_owned(), text)
        };
        let rows: Vec<(String, Option<String>)> = lines.map(told).collect();
        // Where an arm is stretched out the nominal one does not reach it; of a pair both
        // ends go.
        let gone = |label: &String| {
            !label.is_empty() && rows.iter().any(|r| r.0 == *label && r.1.is_none())
        };
        let rows: Vec<String> =
            rows.iter().filter(|r| !gone(&r.0)).filter_map(|r| r.1.clone()).collect();
        let path = self.folder.path().join("check.csv");
        fs::write(&path, format!("{header}\n{}\n", rows.join("\n"))).unwrap();
        verify(&self.model, &Commanded::read(&path, &self.model)?, false)
    }

    /// The joints at which the nominal tool is, turn and all, where the identified one is.
    fn told(&self, sent: &[f64]) -> Option<Vec<f64>> {
        let model = &self.model;
        let small = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
        let marker = model.markers[0].1;
        let real = chain(&model.links(), small, marker).pose(sent);
        let nominal = chain(&model.robot.nominal(), Pose::identity(), marker);
        let mut q = sent.to_vec();
        for _ in 0..8 {
            let step = step(nominal.as_ref(), &q, &real);
            q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q += step);
        }
        let left = step(nominal.as_ref(), &q, &real);
        (left.amax() < 1e-8).then_some(q)
    }
}

fn step(arm: &dyn Kinematics, q: &[f64], to: &Pose<f64>) -> DVector<f64> {
    let pose = arm.pose(q);
    let turn = Rotation3::from_matrix_unchecked(to.rotation * pose.rotation.transpose());
    // Not by the arc cosine of a trace, which rounding takes beyond 3.
    let turn = UnitQuaternion::from_rotation_matrix(&turn).scaled_axis();
    let off = [to.translation - pose.translation, turn];
    let off = DVector::from_fn(6, |k, _| off[k / 3][k % 3]);
    let columns = arm.jacobian(q);
    let jacobian = DMatrix::from_fn(6, q.len(), |k, j| columns[j][k / 3][k % 3]);
    jacobian.svd(true, true).solve(&off, 1e-6).unwrap()
}

#[test]
fn every_kind_is_verified_in_its_own_unit() {
    let wanted: &Wanted = &[
        ("point", 15),
        ("pose", 15),
        ("touch", 30),
        ("distance", 20),
        ("pair", 15),
        ("plate", 15),
        ("range", 20),
        ("inclination", 15),
    ];
    let mut trained = Trained::new(7, TRAINED);
    let after = trained.verified(wanted, true).unwrap();
    let before = trained.verified(wanted, false).unwrap();
    let named: Vec<_> = after.kinds.iter().map(|k| (k.kind, k.unit)).collect();
    let expected = [
        ("point", "mm"),
        ("pose", "mm"),
        ("pose", "deg"),
        ("distance", "mm"),
        ("pair", "mm"),
        ("plate", "mm"),
        ("touch", "mm"),
        ("range", "mm"),
        ("inclination", "deg"),
    ];
    assert_eq!(named, expected);
    assert!(after.kinds.iter().all(|k| k.rows >= 10), "{:?}", after.kinds);
    let sigma = |unit: &str| match unit {
        "mm" => SIGMAS.length * 1e3,
        _ => SIGMAS.angle.to_degrees(),
    };
    for (after, before) in after.kinds.iter().zip(&before.kinds) {
        let what = format!("{after:?}\n{before:?}");
        assert!(before.rms > 4.0 * after.rms, "{what}");
        // What the model predicts is what is measured, compensation off.
        let predicted = before.predicted_without_compensation_rms.unwrap();
        assert!((predicted / before.rms - 1.0).abs() < 0.1, "{what}");
        // No less than the noise of a component, and no more than some times that.
        let guard = after.expanded_uncertainty / sigma(after.unit);
        assert!((2.0..8.0).contains(&guard), "{what}");
        assert!(after.max < 3.0 * after.expanded_uncertainty, "{what}");
        let wide = after.max + 1.01 * after.expanded_uncertainty;
        assert_eq!(after.conformity(wide), Conformity::Pass);
        assert_eq!(after.conformity(after.max), Conformity::NotProven);
        assert_eq!(before.conformity(wide), Conformity::Fail, "{what}");
    }
    // Places that were found are less sure than places that are stated.
    let range = after.kinds.iter().find(|k| k.kind == "range").unwrap();
    assert!(range.expanded_uncertainty > 2.02 * SIGMAS.length * 1e3, "{range:?}");
}

/// The worst of what the tolerances say decides.
#[test]
fn tolerances_of_lengths_and_angles() {
    let mut trained = Trained::new(8, TRAINED);
    let found = trained.verified(&[("touch", 20), ("inclination", 10)], false).unwrap();
    let [touch, level] = &found.kinds[..] else { panic!("{:?}", found.kinds) };
    let [mm, deg] = [touch, level].map(|k| k.max + 1.01 * k.expanded_uncertainty);
    let report = |[mm, deg]: [Option<f64>; 2]| {
        let tolerances = Tolerances { mm, deg };
        let report = VerifyReport::new(String::new(), None, found.clone(), tolerances, Vec::new());
        let report = report.unwrap();
        (report.conformity, report.judged.len())
    };
    assert!(found.points.is_none());
    assert_eq!(report([None, None]), (None, 0));
    assert_eq!(report([Some(mm), None]), (Some(Conformity::Pass), 1));
    assert_eq!(report([Some(mm), Some(deg)]), (Some(Conformity::Pass), 2));
    assert_eq!(report([Some(mm), Some(level.max)]), (Some(Conformity::NotProven), 2));
    assert_eq!(report([Some(1e-6), Some(deg)]), (Some(Conformity::Fail), 2));
}

/// What neither the model nor the user knows is refused; stated, it is not.
#[test]
fn places_that_nobody_knows_are_refused() {
    let mut trained = Trained::new(9, &[("point", 60)]);
    let error = trained.verified(&[("touch", 10)], true).unwrap_err();
    assert!(error.to_string().contains("nobody knows where plane \"P0\" is"), "{error}");
    assert!(error.help().contains("identify with rows of it"), "{}", error.help());
    // Of a pose its point is judged, and that is said.
    let poses = trained.verified(&[("pose", 10)], true).unwrap();
    assert!(poses.kinds.iter().all(|k| k.kind == "point"), "{:?}", poses.kinds);
    assert!(poses.warnings[0].contains("how their marker sits is not known"));
    let planes = trained.cell.planes.iter().enumerate().map(|(k, (normal, far))| {
        let base = &trained.cell.base;
        let turn = |v: [f64; 3]| [0, 1, 2].map(|i| (0..3).map(|j| base[i][j] * v[j]).sum::<f64>());
        let point = turn((normal * *far).into());
        let point = [0, 1, 2].map(|i| (point[i] + base[i][3]) * 1e3);
        let normal = turn((*normal).into());
        format!(
            "[[surfaces]]\nlabel = \"P{k}\"\nshape = \"plane\"\npoint_mm = {point:?}\n\
             normal = {normal:?}\n"
        )
    });
    let stated: String = planes.collect();
    fs::write(trained.folder.path().join("instruments.toml"), stated).unwrap();
    let found = trained.verified(&[("touch", 30)], true).unwrap();
    assert!(found.kinds[0].max < 0.2, "{:?}", found.kinds);
}

/// What the program says, writes and ends with.
#[test]
fn the_verb_tells_of_every_kind() {
    let mut trained = Trained::new(10, TRAINED);
    trained.verified(&[("touch", 20), ("pose", 10)], true).unwrap();
    let folder = trained.folder.path().to_owned();
    let run = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
        command.current_dir(&folder).args(["verify", "model.toml", "check.csv"]);
        let out = command.args(more).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (out.status.code(), text(out.stdout), text(out.stderr))
    };
    let tolerances = ["--tolerance-mm", "0.6", "--tolerance-deg", "0.2", "--out", "out"];
    let (code, said, warned) = run(&tolerances);
    assert_eq!(code, Some(0), "{said}{warned}");
    for what in ["touch, mm", "pose, mm", "pose, deg", "before: as the model predicts"] {
        assert!(said.contains(what), "{said}");
    }
    assert!(said.contains("PASS: every error of kind touch is within 0.6 mm"), "{said}");
    let file = |name: &str| fs::read_to_string(folder.join("out").join(name)).unwrap();
    assert!(file("errors.csv").contains("distance_mm,kind,residual"));
    assert!(file("report.html").contains("Every kind in its own unit"));
    assert!(file("report.json").contains("\"conformity\": \"pass\""));
    trained.verified(&[("touch", 20)], false).unwrap();
    let (code, said, _) = run(&["--tolerance-mm", "0.1"]);
    assert_eq!(code, Some(3), "{said}");
    let (code, _, warned) = run(&["--tolerance-deg", "0.2"]);
    assert_eq!(code, Some(2), "{warned}");
    assert!(warned.contains("no row of check.csv is measured in it"), "{warned}");
}
