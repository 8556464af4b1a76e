//! Kinds of measurements beside one another: what closes the scale, what is a target and
//! what is none, which rows stand out, and which kind is to blame.

use std::path::Path;
use std::process::Command;

use crate::judged::{Judged, cell, read, robot};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::Result;
use truearm_host::evaluate::{Reregister, evaluate};
use truearm_host::identify::certainty::scale;
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Identification, Options, Problem, Scaling, identify};
use truearm_host::model::{Measurements, Model, Robot};
use truearm_simulate::instruments::Cell;

fn tried(robot: &Robot, data: &Measurements) -> Result<Identification> {
    identify(robot, data, &Options::default(), &|_, _| ())
}

fn parsed(robot: &Robot, text: &str, stated: &str) -> Measurements {
    Measurements::parse_with(Path::new("m.csv"), text, robot, stated).unwrap()
}

fn found(robot: &Robot, text: &str, stated: &str) -> Identification {
    tried(robot, &parsed(robot, text, stated)).unwrap()
}

/// What instruments.toml says of the first planes of a cell.
fn planes(cell: &Cell, stated: usize, guess: bool) -> String {
    let plane = |(k, (normal, far)): (usize, &(Vector3<f64>, f64))| {
        let at = normal * *far * 1e3;
        format!(
            "[[surfaces]]\nlabel = \"P{k}\"\nshape = \"plane\"\npoint_mm = [{:?}, {:?}, {:?}]\n\
             normal = [{:?}, {:?}, {:?}]\nguess = {guess}\n",
            at.x, at.y, at.z, normal.x, normal.y, normal.z
        )
    };
    cell.planes.iter().take(stated).enumerate().map(plane).collect()
}

/// The same of the points that closures meet.
fn points(cell: &Cell, stated: usize) -> String {
    let point = |(k, at): (usize, &Vector3<f64>)| {
        let at = at * 500.0;
        format!("[[anchors]]\nlabel = \"C{k}\"\nxyz_mm = [{:?}, {:?}, {:?}]\n", at.x, at.y, at.z)
    };
    cell.anchors.iter().take(stated).enumerate().map(point).collect()
}

/// A fourth plane, so far beside the point that the first three share, m.
fn fourth(cell: &mut Cell, beside: f64) {
    let [a, b, c] = [0, 1, 2].map(|k| cell.planes[k]);
    let normals = Matrix3::from_rows(&[a.0, b.0, c.0].map(|n| n.transpose()));
    let shared = normals.try_inverse().unwrap() * Vector3::new(a.1, b.1, c.1);
    let normal = Vector3::new(1.0, -1.0, 0.2).normalize();
    cell.planes.push((normal, normal.dot(&shared) + beside));
}

fn open(robot: &Robot, text: &str, stated: &str) -> bool {
    let data = parsed(robot, text, stated);
    let start = register(&data, &robot.nominal(), robot.tool).unwrap();
    scale::is_open(&Problem::new(&data, robot, Scaling::Prior), &start)
}

/// Known planes that share a point, and one known point, leave the scale about it open; a
/// known plane beside that point, a second known point, or any length closes it.
#[test]
fn what_shares_a_point_leaves_the_scale_open() {
    let robot = robot();
    for seed in 0..4 {
        let mut rng = ChaCha8Rng::seed_from_u64(300 + seed);
        let first = cell(&robot, &mut rng);
        let touches = first.file(&[("touch", 80)], &mut rng);
        for known in 0..=3 {
            assert!(open(&robot, &touches, &planes(&first, known, false)), "{seed}: {known} of 3");
        }
        for (beside, known, guess, wanted) in [
            (0.0, 4, false, true),
            (0.25, 4, false, false),
            (0.25, 3, false, true),
            (0.25, 4, true, true),
        ] {
            let mut other = first.clone();
            fourth(&mut other, beside);
            let touches = other.file(&[("touch", 100)], &mut rng);
            let stated = planes(&other, known, guess);
            let said = open(&robot, &touches, &stated);
            assert_eq!(said, wanted, "{seed}: {known} of 4, {beside} m beside, guess {guess}");
        }
        let closures = first.file(&[("closure", 60)], &mut rng);
        for (known, wanted) in [(0, true), (1, true), (2, false), (3, false)] {
            let said = open(&robot, &closures, &points(&first, known));
            assert_eq!(said, wanted, "{seed}: {known} of 3 points");
        }
        let with_length = first.file(&[("touch", 80), ("pair", 4)], &mut rng);
        assert!(!open(&robot, &with_length, &planes(&first, 3, false)), "{seed}: pairs");
    }
}

/// No lambda is small enough to shrink the arm where the scale is open, and it is said.
#[test]
fn known_planes_through_one_point_do_not_shrink_the_arm() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(310);
    let cell = cell(&robot, &mut rng);
    let judged = Judged::new(&cell, &mut rng);
    let touches = cell.file(&[("touch", 150)], &mut rng);
    for known in 1..=3 {
        let found = found(&robot, &touches, &planes(&cell, known, false));
        assert_eq!(found.figures.lambda_rule, "maximum-a-posteriori");
        assert!(found.figures.correction_norm < 30.0, "{}", found.figures.correction_norm);
        let told = found.figures.unidentifiable.iter().any(|line| line.contains("overall scale"));
        assert!(told, "{:?}", found.figures.unidentifiable);
        let state = truearm_host::identify::State {
            bases: found.model.stations.iter().map(|s| s.1).collect(),
            markers: found.model.markers.iter().map(|m| m.1).collect(),
            instruments: found.model.instruments.clone(),
            links: found.model.links(),
            terms: Vec::new(),
        };
        let error = judged.error(&state);
        assert!(error < 2e-3, "{known} known: {error} m");
    }
}

/// Joined texts of rows with the same columns.
fn joined(first: &str, second: &str) -> String {
    first.to_owned() + second.split_once('\n').unwrap().1
}

/// A laser sits apart from the target on the same marker, and a ray that no row uses does
/// nothing.
#[test]
fn a_ray_is_no_target() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(320);
    let tracked = cell(&robot, &mut rng);
    let aside = Vector3::new(0.05, 0.02, -0.06);
    let laser = Cell { tool: tracked.tool + aside, ..tracked.clone() };
    let points = tracked.file(&[("point", 30)], &mut rng);
    let ray =
        "[[rays]]\nmarker = \"\"\norigin_mm = [0, 0, 80]\ndirection = [0, 0, 1]\nguess = true\n";
    let [plain, with_ray] = ["", ray].map(|stated| found(&robot, &points, stated).model);
    assert_eq!(plain.corrections, with_ray.corrections);
    assert_eq!(plain.markers, with_ray.markers);

    let both = joined(&laser.file(&[("range", 80)], &mut rng), &points);
    let stated =
        ray.replace("[0, 0, 80]", &format!("{:?}", [0, 1, 2].map(|k| laser.tool[k] * 1e3)));
    let model = found(&robot, &both, &stated).model;
    let (label, tool) = model.tool_marker().unwrap();
    assert_eq!(label, "");
    assert!((tool - tracked.tool).norm() < 2e-3, "{tool}");
    let (_, origin) = model.markers.iter().find(|(label, _)| label == "(ray)").unwrap();
    assert!((origin - laser.tool).norm() < 5e-3, "{origin}");

    // The ray alone says nothing of the tool.
    let alone = found(&robot, &laser.file(&[("range", 90)], &mut rng), &stated).model;
    assert_eq!(alone.tool_marker(), None);
    assert_eq!(alone.tool(), robot.tool);
}

/// The same rows with a column of markers.
fn marked(text: &str, marker: &str) -> String {
    let (header, rows) = text.split_once('\n').unwrap();
    let rows: String = rows.lines().map(|row| format!("{row},{marker}\n")).collect();
    format!("{header},marker\n{rows}")
}

/// An inclinometer is never the tool, in whatever order the rows stand; of several targets
/// without the unlabelled one `pack` asks which.
#[test]
fn the_packed_tool_is_one_that_was_measured() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(330);
    let cell = cell(&robot, &mut rng);
    let lengths = marked(&cell.file(&[("distance", 120)], &mut rng), "");
    let level = marked(&cell.file(&[("inclination", 40)], &mut rng), "level");
    let [one, other] =
        [joined(&lengths, &level), joined(&level, &lengths)].map(|text| found(&robot, &text, ""));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    std::fs::write(&path, other.model.to_toml()).unwrap();
    let read_again = Model::read(&path).unwrap();
    assert_eq!(read_again.not_measured, ["level"]);
    assert_eq!(read_again.tool_marker().unwrap().0, "");
    assert!((one.model.tool() - read_again.tool()).norm() < 1e-7);
    let bars = [&one, &other].map(|found| found.figures.uncertainty.tool_point.rms_mm);
    assert!((bars[0] / bars[1] - 1.0).abs() < 1e-3, "{bars:?}");
    let of_lengths = found(&robot, &lengths, "").figures.uncertainty.tool_point.rms_mm;
    assert!(bars[0] < 1.05 * of_lengths, "{bars:?} with a level, {of_lengths} without");

    let half = |marker: &str, rng: &mut _| marked(&cell.file(&[("point", 25)], rng), marker);
    let two = joined(&half("b", &mut rng), &half("a", &mut rng));
    std::fs::write(&path, found(&robot, &two, "").model.to_toml()).unwrap();
    let pack = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
        command.current_dir(folder.path()).args(["pack", "model.toml", "--out", "p.bin"]);
        let out = command.args(more).output().unwrap();
        (out.status.success(), String::from_utf8_lossy(&out.stderr).into_owned())
    };
    let (fine, said) = pack(&[]);
    assert!(!fine && said.contains("--marker") && said.contains("\"b\""), "{said}");
    let (fine, said) = pack(&["--marker", "b"]);
    assert!(fine, "{said}");
    let (fine, said) = pack(&["--marker", "c", "--force"]);
    assert!(!fine && said.contains("c"), "{said}");
}

/// What stands out of a file does so among rows of its own kind, in their own noise, and
/// no figure counts it.
#[test]
fn rows_stand_out_of_their_own_kind() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(340);
    let mut cell = cell(&robot, &mut rng);
    cell.sigmas.angle = 2e-3;
    let stated = cell.stated(false);
    let train = cell.file(&[("distance", 150), ("inclination", 60)], &mut rng);
    let model = found(&robot, &train, &stated).model;
    let text = cell.file(&[("distance", 200), ("inclination", 60)], &mut rng);
    let mut data = parsed(&robot, &text, &stated);
    data.rows[7].measured[0] += 2e-3;
    let scored = evaluate(&model, &data, Reregister::Nothing).unwrap();
    assert_eq!(scored.left_out, [8]);
    let of = |kind: &str| scored.kinds.iter().find(|k| k.kind == kind).unwrap().rms.unwrap();
    assert!(of("distance") < 0.06, "{}", of("distance"));
    assert!((scored.stats.unwrap().rms_mm - of("distance")).abs() < 1e-6);
    assert!(scored.all_rows.unwrap().rms_mm > 0.12);
}

/// A kind far noisier than stated is named, with what to check.
#[test]
fn a_kind_far_above_its_sigma_is_named() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(350);
    let cell = cell(&robot, &mut rng);
    let text = cell.file(&[("point", 30), ("touch", 90)], &mut rng);
    for (by, named) in [(3.0, false), (30.0, true)] {
        let mut data = read(&robot, &cell, &text);
        data.rows.iter_mut().filter(|row| row.kind.0 != 0).for_each(|row| row.sigma /= by);
        let warnings = tried(&robot, &data).unwrap().figures.warnings;
        let said = warnings.iter().find(|line| line.contains("kind touch"));
        assert_eq!(said.is_some(), named, "{warnings:?}");
        assert!(said.is_none_or(|line| line.contains("probe")), "{said:?}");
    }
    // Alone, what the arm does and the model lacks looks the same.
    let mut data = read(&robot, &cell, &cell.file(&[("point", 60)], &mut rng));
    data.rows.iter_mut().for_each(|row| row.sigma /= 30.0);
    let warnings = tried(&robot, &data).unwrap().figures.warnings;
    let said = warnings.iter().find(|line| line.contains("kind point")).unwrap();
    assert!(said.contains("`truearm diagnose` looks for it") && said.contains("x_mm"), "{said}");
}

/// Where one kind is wrong the error says which, and what to check.
#[test]
fn the_kind_to_blame_is_named() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(360);
    let cell = cell(&robot, &mut rng);
    let wanted = [("distance", 60), ("touch", 50), ("plate", 30), ("inclination", 30)];
    let text = cell.file(&wanted, &mut rng);
    let wrong = |kind: u8, change: &dyn Fn(&mut [f64])| {
        let mut data = read(&robot, &cell, &text);
        for row in data.rows.iter_mut().filter(|row| row.kind.0 == kind) {
            let mut values: Vec<f64> = row.measured.to_vec();
            change(&mut values);
            row.measured = values.into_iter().collect();
        }
        tried(&robot, &data).map(|found| found.figures.warnings)
    };
    let id = |name: &str| truearm_host::observations::by_name(name).unwrap().0;
    let radians = |v: &mut [f64]| v.iter_mut().for_each(|v| *v = v.to_radians());
    // In counts of a tenth of a degree, or of another instrument.
    let tenths = |v: &mut [f64]| v.iter_mut().for_each(|v| *v *= 0.1);
    let metres = |v: &mut [f64]| v[0] /= 1e3;
    type Change<'a> = &'a dyn Fn(&mut [f64]);
    let cases: [(&str, Change, &str); 3] = [
        ("inclination", &radians, "degrees"),
        ("inclination", &tenths, "degrees"),
        ("distance", &metres, "unit of distance_mm"),
    ];
    for (kind, change, help) in cases {
        match wrong(id(kind), change) {
            Err(error) => {
                assert!(error.to_string().contains(&format!("kind {kind}")), "{kind}: {error}");
                println!("{error}\n{}", error.help());
                let known = error.help().contains(help) || error.help().contains("units");
                assert!(known, "{kind}: {}", error.help());
            }
            Ok(warnings) => {
                let named = warnings.iter().any(|w| w.contains(&format!("kind {kind}")));
                assert!(named, "{kind}: {warnings:?}");
            }
        }
    }
}

/// One plane's label under two stations, each with points of its own, is two places.
#[test]
fn a_place_of_two_stations_is_warned_of() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(370);
    let cell = cell(&robot, &mut rng);
    let text = cell.file(&[("point", 50), ("distance", 40)], &mut rng);
    let mut data = read(&robot, &cell, &text);
    let said = |data: &Measurements| {
        let warnings = tried(&robot, data).unwrap().figures.warnings;
        warnings.iter().any(|line| line.contains("a frame of its own"))
    };
    assert!(!said(&data));
    data.stations = vec!["s1".to_owned(), "s2".to_owned()];
    for (i, row) in data.rows.iter_mut().enumerate() {
        row.station = i % 2;
    }
    assert!(said(&data));
}

/// A set of files among the tests' data.
fn of_folder(name: &str) -> (Robot, Measurements) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    let robot = Robot::read(&folder.join("robot.toml")).unwrap();
    let data = Measurements::read(&folder.join("measurements.csv"), &robot).unwrap();
    (robot, data)
}

/// Ranges from an arm of two joints to six planes, with noise of 0.02 mm: the first guess of
/// ray and planes leads to 15 mm where nominal links leave 0.06.
#[test]
fn ranges_of_an_arm_of_two_joints_end_where_they_fit() {
    let (robot, data) = of_folder("range");
    let found = tried(&robot, &data).unwrap();
    let kind = &found.figures.kinds[0];
    let (nominal, identified) = (kind.nominal_rms.unwrap(), kind.identified_rms.unwrap());
    assert!(nominal < 0.07 && identified < 0.02, "{nominal} {identified}");
}

/// Two lengths to each of three unknown feet can always be met: none is a gross error. From
/// between the two places no step led to a foot, and one was 708 mm off.
#[test]
fn two_lengths_to_an_unknown_foot_are_met() {
    let (robot, data) = of_folder("feet");
    let options = Options { allow_few_poses: true, ..Options::default() };
    let found = identify(&robot, &data, &options, &|_, _| ()).unwrap();
    assert!(found.rows.iter().all(|row| !row.flagged));
    let lengths = found.figures.kinds.iter().find(|k| k.kind == "distance").unwrap();
    assert!(lengths.identified_rms.unwrap() < 1e-3, "{:?}", lengths.identified_rms);
}
