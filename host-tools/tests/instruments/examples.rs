//! The examples of `examples/instruments`: one file a kind, each with the columns that the kind
//! needs and no others, of one arm in one cell. Its pages in the book run them.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::judged::{cell, robot};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_simulate::instruments::Cell;
use truearm_simulate::robots::UR10_LIKE;
use truearm_simulate::{rigid, vector};

/// File and what is in it, so many of each.
const FILES: [(&str, &[(&str, usize)]); 10] = [
    ("distances", &[("distance", 90)]),
    ("touches", &[("touch", 60), ("sphere", 40)]),
    ("holes", &[("plate", 40)]),
    ("points", &[("point", 40)]),
    ("poses", &[("pose", 30)]),
    ("pairs", &[("pair", 120)]),
    ("ranges", &[("range", 120)]),
    ("inclinations", &[("inclination", 60)]),
    ("closures", &[("closure", 60)]),
    ("corners", &[("pixel", 16)]),
];

/// Without the columns in which no row has anything, and what a user would not write: a
/// nanometre, and sigmas that say what is assumed anyway.
fn tidy(text: &str) -> String {
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let kinds = rows[0].iter().position(|name| *name == "kind").unwrap();
    let has = |unit: &str| {
        let of = |kind: &str| match unit {
            "sigma_deg" => matches!(kind, "pose" | "inclination"),
            "sigma_px" => kind == "pixel",
            _ => !matches!(kind, "inclination" | "pixel"),
        };
        rows[1..].iter().any(|row| of(row[kinds]))
    };
    let kept = (0..rows[0].len()).filter(|k| match rows[0][*k] {
        name if name.starts_with("sigma") => has(name),
        _ => rows[1..].iter().any(|row| !row[*k].is_empty()),
    });
    let kept: Vec<usize> = kept.collect();
    let cell = |column: &str, text: &str| {
        let digits = match column.rsplit('_').next() {
            Some("mm") => 4,
            Some("deg") => 6,
            Some("px") => 2,
            _ if column.starts_with('q') => 8,
            _ => return text.to_owned(),
        };
        text.parse().map_or(text.to_owned(), |x: f64| format!("{x:.digits$}"))
    };
    let line = |row: &Vec<&str>| {
        let cells: Vec<String> = kept.iter().map(|k| cell(rows[0][*k], row[*k])).collect();
        cells.join(",") + "\n"
    };
    rows.iter().map(line).collect()
}

/// What stands around the arm as somebody with a rule found it, to a centimetre: what is
/// known better are the coordinates of the holes and how the camera sees.
fn paced(cell: &Cell) -> String {
    let cm = |v: &Vector3<f64>| v.map(|x| (x * 100.0).round() as i32 * 10);
    let point = |v: &Vector3<f64>| format!("[{}, {}, {}]", cm(v).x, cm(v).y, cm(v).z);
    let way = |v: &Vector3<f64>| format!("[{:.2}, {:.2}, {:.2}]", v.x, v.y, v.z);
    let mut out = String::new();
    let mut say = |text: String| out.push_str(&text);
    for (k, anchor) in cell.anchors.iter().enumerate() {
        let at = point(anchor);
        say(format!("[[anchors]]\nlabel = \"A{k}\"\nguess = true\nxyz_mm = {at}\n\n"));
    }
    for (k, anchor) in cell.anchors.iter().enumerate() {
        let at = point(&(anchor * 0.5));
        say(format!("[[anchors]]\nlabel = \"C{k}\"\nguess = true\nxyz_mm = {at}\n\n"));
    }
    for (k, (normal, far)) in cell.planes.iter().enumerate() {
        let (at, normal) = (point(&(normal * *far)), way(normal));
        say(format!(
            "[[surfaces]]\nlabel = \"P{k}\"\nshape = \"plane\"\nguess = true\n\
             point_mm = {at}\nnormal = {normal}\n\n"
        ));
    }
    let (centre, radius) = (point(&cell.sphere.0), cell.sphere.1 * 1e3);
    say(format!(
        "[[surfaces]]\nlabel = \"ball\"\nshape = \"sphere\"\nguess = true\n\
         point_mm = {centre}\nradius_mm = {radius}\n\n"
    ));
    let seat = Vector3::from_fn(|i, _| cell.plate[i][3]);
    say(format!("[[plates]]\nlabel = \"plate\"\nguess = true\nxyz_mm = {}\n", point(&seat)));
    say("rpy_deg = [0, 0, 0]\n[plates.holes]\n".to_owned());
    for (k, hole) in cell.holes.iter().enumerate() {
        say(format!("H{k} = {}\n", point(hole)));
    }
    let [fx, fy, cx, cy] = cell.camera.pinhole;
    let place = Vector3::from_fn(|i, _| cell.camera.place[i][3]);
    say(format!(
        "\n[[cameras]]\nlabel = \"cam\"\nmounted = \"flange\"\nguess = true\nxyz_mm = {}\n\
         rpy_deg = [0, 0, 0]\nfocal_px = [{fx}, {fy}]\ncentre_px = [{cx}, {cy}]\n\
         image_px = [1280, 1024]\ndistortion = {:?}\n",
        point(&place),
        cell.camera.brown
    ));
    out
}

/// `UPDATE_EXAMPLES=1` writes them anew.
#[test]
fn files_are_what_the_cell_gives() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/instruments");
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    // A tracker that was told roughly where the arm stands.
    let base = rigid(&(vector(&mut rng) * 0.005), &(vector(&mut rng) * 0.005));
    let cell = Cell { base, ..cell(&robot, &mut rng) };
    let limited = UR10_LIKE.replace(" },\n", ", limits_deg = [-175, 175] },\n");
    let mut texts = vec![("robot.toml".to_owned(), limited)];
    texts.push(("instruments.toml".to_owned(), paced(&cell)));
    for (name, wanted) in FILES {
        texts.push((format!("{name}.csv"), tidy(&cell.file(wanted, &mut rng))));
    }
    for (name, text) in &texts {
        let path = folder.join(name);
        if std::env::var_os("UPDATE_EXAMPLES").is_some() {
            fs::write(&path, text).unwrap();
        }
        let there = fs::read_to_string(&path).unwrap_or_default().replace("\r\n", "\n");
        assert!(there == *text, "{name}: run UPDATE_EXAMPLES=1 cargo test --test instruments");
    }
}

/// No tracker: lengths, touches and a plate in one solve.
#[test]
fn three_kinds_need_no_tracker() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/instruments");
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    command.current_dir(&folder).args(["identify", "robot.toml", "--json"]);
    for name in ["distances", "touches", "holes"] {
        command.args(["--data", &format!("{name}.csv")]);
    }
    let out = command.output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let report: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let kinds = report["kinds"].as_array().unwrap();
    assert_eq!(kinds.len(), 3);
    for kind in kinds {
        let scale = kind["noise_scale"].as_f64().unwrap();
        assert!((0.6..1.5).contains(&scale), "{kind}");
        let [before, after] =
            ["nominal_rms", "cross_validated_rms"].map(|key| kind[key].as_f64().unwrap());
        assert!(after < 0.1 * before, "{kind}");
    }
}
