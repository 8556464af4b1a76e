//! Readers of everything that users bring, on thousands of broken files: errors are
//! expected, panics and endless loops are not. Deterministic: a failure names file,
//! reader and number of the mutation.

#[path = "../published/mod.rs"]
mod published;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::mutate::mutated;
use truearm::blob::Blob;
use truearm_host::blob::image::MemoryRegions;
use truearm_host::blob::{contents, describe, explain, pack, unpack};
use truearm_host::convert::Identified;
use truearm_host::convert::table::{
    Convention, Units, mdh_csv, robot_of_table, standard_dh, standard_dh_csv,
};
use truearm_host::convert::urdf::{Document, Ends, calibrated_like, robot_of_urdf, urdf_text};
use truearm_host::files::Wanted;
use truearm_host::identify::{Options, identify};
use truearm_host::import::{ImportOptions, import};
use truearm_host::model::{Commanded, Measurements, Model, Path as Rows, Robot};
use truearm_host::paths::write::Template;
use truearm_host::paths::{Forward, Inverse, View, forward_csv, inverse_csv};

/// Broken versions of each fixture.
const EACH: u64 = 1000;
/// No broken file of a few kilobytes takes so long.
const LONGEST: Duration = Duration::from_secs(20);

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

/// A fixture, of long tables the first rows.
fn fixture(path: &Path) -> Vec<u8> {
    let bytes = std::fs::read(path).unwrap();
    let most = if path.extension().is_some_and(|e| e == "csv") { 14 } else { usize::MAX };
    bytes.split_inclusive(|b| *b == b'\n').take(most).flatten().copied().collect()
}

fn robot() -> Robot {
    Robot::parse(Path::new("robot.toml"), published::ROBOT).unwrap()
}

/// Reads every mutation of some bytes; what panicked, and how long the longest took.
fn all(name: &str, bytes: &[u8], each: u64, read: impl Fn(&[u8])) {
    let (mut longest, mut panics) = (Duration::ZERO, Vec::new());
    for number in 0..each {
        let broken = mutated(bytes, number);
        let start = Instant::now();
        if catch_unwind(AssertUnwindSafe(|| read(&broken))).is_err() {
            panics.push(number);
        }
        longest = longest.max(start.elapsed());
    }
    assert!(panics.is_empty(), "{name}: mutations {panics:?} panic");
    assert!(longest < LONGEST, "{name}: a mutation takes {longest:?}");
}

/// What is read as text, as the reader of files does.
fn text(bytes: &[u8]) -> Option<String> {
    let text = String::from_utf8(bytes.to_vec()).ok()?;
    Some(text.strip_prefix('\u{feff}').map_or(text.clone(), str::to_owned))
}

/// All files of a name below a folder.
fn found(folder: &Path, name: &str, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found(&path, name, out);
        } else if path.file_name().is_some_and(|n| n == name) {
            out.push(path);
        }
    }
}

fn of_tests(name: &str) -> Vec<PathBuf> {
    let mut all = Vec::new();
    found(&data(""), name, &mut all);
    all.sort();
    assert!(all.len() > 3, "{name}");
    all
}

#[test]
fn robots() {
    for path in of_tests("robot.toml") {
        all(&path.display().to_string(), &fixture(&path), EACH, |bytes| {
            let Some(text) = text(bytes) else { return };
            let Ok(robot) = Robot::parse(Path::new("robot.toml"), &text) else { return };
            let q = vec![0.1; robot.joints.len()];
            let _ = robot.nominal_target()(&q);
            let rows = "q1_deg,x_mm,y_mm,z_mm\n1,2,3,4\n";
            let _ = Measurements::parse(Path::new("m.csv"), rows, &robot);
        });
    }
}

#[test]
fn measurements() {
    for path in of_tests("measurements.csv") {
        let robot = Robot::read(&path.with_file_name("robot.toml"))
            .or_else(|_| Robot::read(&path.parent().unwrap().with_file_name("robot.toml")));
        let robot = robot.unwrap();
        let bytes = fixture(&path);
        let name = path.display().to_string();
        all(&name, &bytes, EACH, |bytes| {
            let Some(text) = text(bytes) else { return };
            let path = Path::new("m.csv");
            if let Ok(data) = Measurements::parse(path, &text, &robot) {
                let _ = (data.covered(), data.shared(&data), data.when(0));
            }
            for wanted in [Wanted::Joints, Wanted::Poses, Wanted::Either] {
                let Ok(rows) = Rows::parse(path, &text, &robot, wanted) else { continue };
                let _ = rows.within_limits(&robot);
            }
            let _ = Commanded::parse(path, &text, &robot);
        });
    }
}

/// `verify`'s files, and paths that are solved.
#[test]
fn paths() {
    let robot = robot();
    let model = Model::nominal(robot.clone());
    let forward = Forward::nominal(&model, &View::default()).unwrap();
    let rows = String::from_utf8(fixture(&data("seed-table-8/measurements.csv"))).unwrap();
    let commanded =
        (1..=6).fold(rows.clone(), |t, j| t.replace(&format!("q{j}_"), &format!("cmd{j}_")));
    all("commanded.csv", commanded.as_bytes(), EACH, |bytes| {
        let Some(text) = text(bytes) else { return };
        let _ = Commanded::parse(Path::new("c.csv"), &text, &robot);
    });
    all("joints.csv", rows.as_bytes(), EACH, |bytes| {
        let Some(text) = text(bytes) else { return };
        let Ok(path) = Rows::parse(Path::new("p.csv"), &text, &robot, Wanted::Joints) else {
            return;
        };
        let _ = forward_csv(&path, &robot, &forward.all(&path.data));
    });
    let poses = "x_mm,y_mm,z_mm,qx,qy,qz,qw,time_s\n400,300,500,0,1,0,0,1.5\n-400,200,300,0.5,0.5,0.5,0.5,2\n";
    all("poses.csv", poses.as_bytes(), EACH / 4, |bytes| {
        let Some(text) = text(bytes) else { return };
        let Ok(path) = Rows::parse(Path::new("p.csv"), &text, &robot, Wanted::Poses) else {
            return;
        };
        let found =
            Inverse::new(&forward, &robot).follow(&path.data, &path.targets, Some(&[0.1; 6]));
        let _ = inverse_csv(&path, &robot, &found.rows);
    });
    let template = "header = \"DEF p() ; {rows} {{\\n\"\nrow = \"{row} {q1_deg:.3} {qx}\\n\"\nfooter = \"END\"\n";
    all("template.toml", template.as_bytes(), EACH, |bytes| {
        let Some(text) = text(bytes) else { return };
        let _ = Template::parse(Path::new("t.toml"), &text);
    });
}

/// Models, and all that is made of those that are still read.
#[test]
fn models() {
    let robot = robot();
    let rows = Measurements::read(&data("seed-table-8/measurements.csv"), &robot).unwrap();
    let found = identify(&robot, &rows, &Options::default(), &|_, _| ()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.toml");
    let long = Path::new("path.csv");
    let path = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n10,-80,70,-60,-80,20\n";
    all("model.toml", found.model.to_toml().as_bytes(), EACH, |bytes| {
        std::fs::write(&file, bytes).unwrap();
        let _ = Model::read_or_nominal(&file);
        let Ok(model) = Model::read(&file) else { return };
        let _ = (model.to_sound_toml(), pack(&model, None));
        if let Ok(path) = Rows::parse(long, path, &model.robot, Wanted::Joints)
            && let Ok(forward) = Forward::real(&model, &View::default())
        {
            let _ = forward_csv(&path, &model.robot, &forward.all(&path.data));
        }
        if let Ok(arm) = Identified::of(&model, None) {
            let _ = (mdh_csv(&arm), standard_dh_csv(&standard_dh(&model, &arm)));
            let _ = urdf_text(&model, &arm);
        }
    });
}

#[test]
fn blobs() {
    for entry in std::fs::read_dir(data("golden")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "blob") {
            continue;
        }
        let good = std::fs::read(&path).unwrap();
        all(&path.display().to_string(), &good, EACH, |bytes| match Blob::check(bytes) {
            Ok(blob) => {
                let _ = (describe(&blob, bytes.len(), false), contents(&blob, bytes.len()));
                let _ = unpack(bytes, Path::new("a.bin"), None);
            }
            Err(error) => drop(explain(bytes, &error.into())),
        });
    }
    let script = std::fs::read(data("../../memory.x")).unwrap();
    all("memory.x", &script, EACH, |bytes| {
        let Some(text) = text(bytes) else { return };
        let _ = MemoryRegions::parse(Path::new("memory.x"), &text);
    });
}

#[test]
fn urdfs() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arm.urdf");
    let arms = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/urdf");
    for entry in std::fs::read_dir(arms).unwrap() {
        let path = entry.unwrap().path();
        let name = path.display().to_string();
        all(&name, &std::fs::read(&path).unwrap(), EACH, |bytes| {
            std::fs::write(&file, bytes).unwrap();
            let Ok(made) = robot_of_urdf(&file, &Ends::default()) else { return };
            let Ok(robot) = Robot::parse(Path::new("robot.toml"), &made.text) else { return };
            let mut model = Model::nominal(robot);
            model.markers.push((String::new(), model.robot.tool));
            let (Ok(arm), Ok(document)) = (Identified::of(&model, None), Document::read(&file))
            else {
                return;
            };
            let _ = calibrated_like(&document, &Ends::default(), &model, &arm);
        });
    }
}

#[test]
fn tables_of_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("dh.csv");
    for table in [
        "alpha_deg,a_mm,theta_offset_deg,d_mm\n0,100,0,10\n90,200,-90,20\n-90,0,0,0\n",
        "joint;alpha_rad;a_m;theta_offset_rad;d_m;type\n1;0;0,1;0;0,01;revolute\n2;1,5707;0,2;0;0;prismatic\n",
        "# from a data sheet\nname,theta,d,a,alpha\nJ1,q1,0.1273,0,pi/2\nJ2,q2 - pi/2,0,-0.612,0\n",
    ] {
        for convention in [Convention::Standard, Convention::Modified] {
            all(table, table.as_bytes(), EACH, |bytes| {
                std::fs::write(&file, bytes).unwrap();
                let Ok(text) = robot_of_table(&file, convention, &Units::default()) else { return };
                let _ = Robot::parse(Path::new("robot.toml"), &text);
            });
        }
    }
}

#[test]
fn imports() {
    let folder = tempfile::tempdir().unwrap();
    let robot = robot();
    let headings = ["J1", "J2", "J3", "J4", "J5", "J6", "X [mm]", "Y [mm]", "Z [mm]"];
    let semicolons =
        published::text("J1;J2;J3;J4;J5;J6;X;Y;Z\n", &published::scaled(true, false), ";", ",");
    let files: [(&str, Vec<u8>, u64); 5] = [
        ("plain.csv", published::plain().into_bytes(), EACH),
        ("semicolons.csv", published::latin1(&semicolons), EACH),
        ("wide.txt", published::utf16(&semicolons, true), EACH),
        ("book.xlsx", published::xlsx("Data", &headings, &published::rows()), EACH),
        ("sheet.ods", published::ods(&headings, &published::rows()), EACH),
    ];
    for (name, bytes, each) in &files {
        let file = folder.path().join(name);
        all(name, bytes, *each, |bytes| {
            std::fs::write(&file, bytes).unwrap();
            let path = std::slice::from_ref(&file);
            let _ = import(path, None, None, &ImportOptions::default());
            let _ = import(path, Some(&robot), None, &ImportOptions::default());
        });
    }
    let file = folder.path().join("good.csv");
    std::fs::write(&file, published::plain()).unwrap();
    let files = [file];
    let good = import(&files, None, None, &ImportOptions::default()).unwrap();
    all("import.toml", good.config.as_bytes(), EACH, |bytes| {
        let Some(text) = text(bytes) else { return };
        let config = Some((Path::new("import.toml"), text.as_str()));
        let _ = import(&files, Some(&robot), config, &ImportOptions::default());
    });
}

const INSTRUMENTS: &str = "up = [0.0, 0.0, 1.0]\n\
    [[anchors]]\nlabel = \"a\"\nxyz_mm = [1000.0, 0.0, 100.0]\nguess = true\n\
    [[surfaces]]\nlabel = \"s\"\nshape = \"sphere\"\npoint_mm = [500.0, 0.0, 0.0]\nradius_mm = 25.0\n\
    [[surfaces]]\nlabel = \"t\"\nshape = \"plane\"\npoint_mm = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\n\
    [[probes]]\nmarker = \"m\"\nradius_mm = 3.0\n\
    [[plates]]\nlabel = \"p\"\nmounted = \"fixed\"\nxyz_mm = [300.0, 0.0, 0.0]\nrpy_deg = [0.0, 0.0, 10.0]\n\
    [plates.holes]\nh1 = [0.0, 0.0, 0.0]\nh2 = [50.0, 0.0, 0.0]\n\
    [[cameras]]\nlabel = \"c\"\nmounted = \"fixed\"\nfocal_px = [900.0, 900.0]\ncentre_px = [640.0, 512.0]\n\
    distortion = [0.1, 0.0, 0.0, 0.0, 0.0]\nintrinsics = \"known\"\n\
    [[rays]]\nmarker = \"m\"\norigin_mm = [0.0, 0.0, 50.0]\ndirection = [0.0, 0.0, 1.0]\n\
    [[markers]]\nmarker = \"m\"\nxyz_mm = [0.0, 0.0, 100.0]\nrpy_deg = [0.0, 0.0, 0.0]\n";

/// Rows of all kinds, and what they refer to.
#[test]
fn instruments() {
    let robot = robot();
    let names = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,kind,marker,x_mm,y_mm,z_mm,qx,qy,qz,qw,\
                 distance_mm,anchor,pair,surface,plate,hole,range_mm,incl_x_deg,incl_y_deg,camera,image,\
                 u_px,v_px,sigma_mm,sigma_deg,sigma_px\n";
    let mut rows = names.to_owned();
    for (i, cells) in [
        "point,m,1,2,3,,,,,,,,,,,,,,,,,,0.1,,",
        "pose,m,1,2,3,0,0,0,1,,,,,,,,,,,,,,0.1,0.01,",
        "distance,m,,,,,,,,500,a,,,,,,,,,,,,0.1,,",
        "pair,m,,,,,,,,200,,k1,,,,,,,,,,,0.1,,",
        "pair,m,,,,,,,,200,,k1,,,,,,,,,,,0.1,,",
        "touch,m,,,,,,,,,,,s,,,,,,,,,,0.1,,",
        "plate,m,,,,,,,,,,,,p,h1,,,,,,,,0.1,,",
        "range,m,,,,,,,,,,,t,,,300,,,,,,,0.1,,",
        "inclination,,,,,,,,,,,,,,,,1.5,-2,,,,,,0.01,",
        "pixel,,,,,,,,,,,,,p,h2,,,,c,i1,600,500,,,0.2",
        "closure,m,,,,,,,,,,,,,,,,,,,,,0.1,,",
    ]
    .iter()
    .enumerate()
    {
        let q: Vec<String> = (0..6).map(|j| ((i * 17 + j * 29) % 100).to_string()).collect();
        rows += &format!("{},{cells}\n", q.join(","));
    }
    all("kinds.csv", rows.as_bytes(), EACH, |bytes| {
        let Some(text) = text(bytes) else { return };
        let _ = Measurements::parse_with(Path::new("m.csv"), &text, &robot, INSTRUMENTS);
        let _ = Measurements::parse_with(Path::new("m.csv"), &text, &robot, "");
    });
    all("instruments.toml", INSTRUMENTS.as_bytes(), EACH, |bytes| {
        let Some(text) = text(bytes) else { return };
        let _ = Measurements::parse_with(Path::new("m.csv"), &rows, &robot, &text);
    });
}
