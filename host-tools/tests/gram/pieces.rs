//! Files that are read in pieces.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::files::Pieces;
use truearm_host::gram::{DRAWN, identify_in_pieces};
use truearm_host::identify::{Identification, LambdaRule, Options, Scaling, identify};
use truearm_host::model::{Measurements, Model, Robot};
use truearm_host::{ErrorKind, Result};

use crate::parts::{SIGMA, apart, measured, settled};
use crate::simulated::{ON_RAIL, Truth, UR10_LIKE, robot};

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> (tempfile::TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let write = |(name, text): &(&str, &str)| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let paths = files.iter().map(write).collect();
    (folder, paths)
}

/// What was found, and rows drawn.
pub struct Whole {
    pub found: Identification,
    pub sample: Measurements,
}

pub fn in_pieces(robot: &Robot, paths: &[PathBuf], options: &Options) -> Result<Whole> {
    let paths: Vec<&PathBuf> = paths.iter().collect();
    let mut rows = Pieces::of(&paths, robot)?;
    let sample = rows.sample(DRAWN)?;
    let found = identify_in_pieces(&rows, &sample, options, &|_, _| ())?;
    Ok(Whole { found, sample: sample.data })
}

fn text(header: &str, rows: &[String]) -> String {
    let mut text = format!("{header}\n");
    rows.iter().for_each(|row| writeln!(text, "{row}").unwrap());
    text
}

/// Two files, remarks and empty lines in them, rows of gross errors, more rows than one piece has
/// and than are drawn: what all rows say together, to the last step that is taken.
#[test]
fn files_in_pieces_are_one_run() {
    let (robot, header, mut rows) = measured(30_000);
    for row in rows.iter_mut().step_by(997) {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        cells[6] = cells[6].replace('.', "9.");
        *row = cells.join(",");
    }
    let first = text(&header, &rows[..17_000]).replacen('\n', "\n# read \"anew\n\n", 3);
    let second = text(&header, &rows[17_000..]);
    let (_folder, paths) = folder(&[("a.csv", &first), ("b.csv", &second)]);
    let found = in_pieces(&robot, &paths, &Options::default()).unwrap();
    let figures = &found.found.figures;
    let drawn = figures.drawn.as_ref().unwrap();
    assert_eq!((figures.rows, figures.poses), (rows.len(), rows.len()));
    assert_eq!(drawn.flagged, rows.len().div_ceil(997));
    assert!(drawn.rows < 21_000 && drawn.rows > 19_000, "{}", drawn.rows);
    let all = Measurements::parse(Path::new("all.csv"), &text(&header, &rows), &robot).unwrap();
    let start = identify(&robot, &found.sample, &Options::default(), &|_, _| ()).unwrap().model;
    let parts = settled(&start, std::slice::from_ref(&all));
    let model = &found.found.model;
    assert!(apart(model, &parts.model) < 1e-6, "{}", apart(model, &parts.model));
    let [a, b] = [drawn.cross_validated_rms_mm, parts.cross_validated_rms_mm].map(Option::unwrap);
    assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    // Distances of those drawn are those of all but for chance.
    for (of, exact) in [
        (figures.identified.unwrap().rms_mm, drawn.rms_mm),
        (figures.cross_validated.unwrap().rms_mm, a),
    ] {
        assert!((of / exact - 1.0).abs() < 0.02, "{of} {exact}");
    }
    assert_eq!(model.gram, None);
    assert_eq!(model.covered, parts.model.covered);
    let bars = figures.uncertainty.parameters.iter().map(|bar| bar.half_width);
    let units = |k: usize| [1_f64.to_degrees(), 1e3][usize::from(k % 5 == 1 || k % 5 == 3)];
    let of_model = model.uncertainties.iter().flat_map(|u| u.to_array());
    for (k, (bar, sigma)) in bars.zip(of_model).enumerate() {
        let sigma = sigma * units(k) * 1.96;
        assert!((bar / sigma - 1.0).abs() < 0.02, "{k}: {bar} {sigma}");
    }
    // And `identify`, which judges a row by the others.
    let whole = identify(&robot, &all, &Options::default(), &|_, _| ()).unwrap();
    let whole_bars = &whole.figures.uncertainty.parameters;
    for (a, b) in figures.uncertainty.parameters.iter().zip(whole_bars) {
        let off = (a.correction - b.correction).abs() / b.half_width;
        assert!(off < 0.01, "{}: {off} half widths", a.name);
    }
}

/// Where rows tell as much as ten million do, here by their small noise, what only lambda tells
/// apart is no slower found: ten rounds and more it took.
#[test]
fn few_rounds_however_much_the_rows_tell() {
    let sigma = 1.6e-6;
    let robot = Robot { sigma, ..robot(UR10_LIKE) };
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let truth = Truth::draw_sized(&robot, 1, 1, 2.0, &mut rng);
    let (_folder, paths) = folder(&[("a.csv", &truth.measure(25_000, sigma, &mut rng))]);
    let found = in_pieces(&robot, &paths, &Options::default()).unwrap().found;
    let drawn = found.figures.drawn.as_ref().unwrap();
    assert!(drawn.rounds <= 5, "{} rounds", drawn.rounds);
    assert!((drawn.rms_mm / (sigma * 3_f64.sqrt() * 1e3) - 1.0).abs() < 0.02, "{}", drawn.rms_mm);
}

/// The last bit does not depend on how many threads there are.
#[test]
fn the_same_bits_on_any_number_of_cores() {
    let (robot, header, rows) = measured(25_000);
    let (_folder, paths) = folder(&[("a.csv", &text(&header, &rows))]);
    let on = |threads: usize| -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| in_pieces(&robot, &paths, &Options::default()).unwrap());
        let model = found.found.model;
        let numbers = model.corrections.iter().chain(&model.uncertainties);
        numbers.flat_map(|p| p.to_array()).map(f64::to_bits).collect()
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}

/// Of a station with few rows as many as there are; a rail; a rule that gives lambda.
#[test]
fn few_rows_of_a_station_are_among_those_drawn() {
    let robot = robot(ON_RAIL);
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let truth = Truth::draw(&robot, 2, 1, &mut rng);
    let all = truth.measure(60_000, SIGMA, &mut rng);
    let mut lines: Vec<&str> = all.lines().collect();
    let mut few = 0;
    lines.retain(|line| {
        !line.contains(",S1,") || {
            few += 1;
            few <= 70
        }
    });
    let (_folder, paths) = folder(&[("a.csv", &(lines.join("\n") + "\n"))]);
    let options = Options { rule: LambdaRule::Fixed(1.0), ..Options::default() };
    let found = in_pieces(&robot, &paths, &options).unwrap();
    let station = found.sample.stations.iter().position(|label| label == "S1").unwrap();
    let drawn = found.sample.rows.iter().filter(|row| row.station == station).count();
    assert!((60..=70).contains(&drawn), "{drawn}");
    assert_eq!(found.found.model.provenance.lambda, 1.0);
    let state = truth.state();
    let [a, b] = [&found.found.model.stations[station].1, &state.bases[1]];
    // Where the data do not tell base from first link, both may move: the same points.
    let point = nalgebra::Vector3::new(0.8, 0.1, 0.6);
    assert!((a.transform_point(&point) - b.transform_point(&point)).norm() < 5e-3);
}

#[test]
fn what_is_wrong_is_named_where_it_stands() {
    let (robot, header, mut rows) = measured(20_000);
    let fails = |rows: &[String], header: &str, options: &Options| {
        let (_folder, paths) = folder(&[("a.csv", &text(header, rows))]);
        in_pieces(&robot, &paths, options).map(|_| ()).unwrap_err()
    };
    let sound = rows[15_000].clone();
    rows[15_000] = sound.replacen('.', "x", 1);
    let error = fails(&rows, &header, &Options::default());
    assert!(error.to_string().contains("a.csv:15002, column q1_deg"), "{error}");
    rows[15_000] = sound.rsplit_once(',').unwrap().0.to_owned();
    let error = fails(&rows, &header, &Options::default());
    assert!(error.to_string().contains("a.csv:15002: 10 cells"), "{error}");
    // Two stations that differ in case, far from each other.
    rows[15_000] = sound.replace(",S0,", ",s0,").replace(",S1,", ",s1,");
    let error = fails(&rows, &header, &Options::default());
    assert!(error.to_string().contains("differ in case only"), "{error}");
    rows[15_000] = sound;
    let printed = Options { scaling: Scaling::Printed, ..Options::default() };
    assert_eq!(fails(&rows, &header, &printed).kind(), ErrorKind::Usage);
    for rule in [LambdaRule::Gcv, LambdaRule::KFold, LambdaRule::LCurve, LambdaRule::TwoStep] {
        let chosen = Options { rule, ..Options::default() };
        assert_eq!(fails(&rows, &header, &chosen).kind(), ErrorKind::Usage);
    }
    let kinds = format!("{header},kind,anchor,distance_mm");
    rows.iter_mut().for_each(|row| row.push_str(",,,"));
    let last = rows.last_mut().unwrap();
    last.truncate(last.len() - 3);
    last.push_str(",distance,wire,1000");
    let error = fails(&rows, &kinds, &Options::default());
    assert!(error.to_string().contains("a.csv:20001: a distance"), "{error}");
    assert_eq!(error.kind(), ErrorKind::NotPoints);
    let error = fails(&[], &header, &Options::default());
    assert_eq!(error.kind(), ErrorKind::NoRows);
    let (_folder, paths) = folder(&[("a.csv", "")]);
    assert!(in_pieces(&robot, &paths, &Options::default()).is_err());
    let nowhere = [PathBuf::from("nowhere.csv")];
    let error = in_pieces(&robot, &nowhere, &Options::default()).map(|_| ()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Io);
}

/// What stands twice is one, wherever: another file, the other end of the same one, in part.
#[test]
fn rows_that_stand_twice_count_once() {
    let (robot, header, rows) = measured(9000);
    let once = text(&header, &rows);
    let twice = text(&header, &[&rows[..], &rows[..4000], &rows[8000..]].concat());
    let (_folder, paths) = folder(&[("a.csv", &once), ("b.csv", &once), ("c.csv", &twice)]);
    let of = |paths: &[PathBuf]| in_pieces(&robot, paths, &Options::default()).unwrap().found;
    let one = of(&paths[..1]);
    let bars = |found: &Identification| -> Vec<f64> {
        found.figures.uncertainty.parameters.iter().map(|bar| bar.half_width).collect()
    };
    for (paths, spare) in [(&paths[..2], 9000), (&paths[2..], 5000), (&paths[..], 23_000)] {
        let found = of(paths);
        let drawn = found.figures.drawn.as_ref().unwrap();
        assert_eq!(drawn.twice, spare);
        assert_eq!(found.figures.poses, 9000);
        assert!(apart(&found.model, &one.model) < 1e-6);
        for (a, b) in bars(&found).iter().zip(bars(&one)) {
            assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
        }
    }
}

/// Gross errors widen no error bar, and are told in their file and line.
#[test]
fn gross_errors_are_no_noise() {
    let (robot, header, mut rows) = measured(12_000);
    let sound = text(&header, &rows);
    for row in rows.iter_mut().skip(7000).step_by(3) {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        cells[7] = cells[7].replace('.', "9.");
        *row = cells.join(",");
    }
    let [first, second] = [&rows[..6000], &rows[6000..]].map(|rows| text(&header, rows));
    let (_folder, paths) = folder(&[("sound.csv", &sound), ("a.csv", &first), ("b.csv", &second)]);
    let options = Options::default();
    let clean = in_pieces(&robot, &paths[..1], &options).unwrap().found;
    let found = in_pieces(&robot, &paths[1..], &options).unwrap().found;
    assert_eq!(found.figures.drawn.as_ref().unwrap().flagged, 5000_usize.div_ceil(3));
    for outlier in &found.figures.outliers {
        assert!(outlier.file.ends_with("b.csv") && (outlier.line - 1002) % 3 == 0, "{outlier:?}");
        assert_eq!(outlier.coordinates, ["y"]);
    }
    // A seventh of the rows less, a fourteenth more of error.
    let bars = found.figures.uncertainty.parameters.iter();
    for (a, b) in bars.zip(&clean.figures.uncertainty.parameters) {
        let ratio = a.half_width / b.half_width;
        assert!((0.99..1.12).contains(&ratio), "{}: {ratio}", a.name);
    }
}

/// As a user asks for it; rows that were fitted are no validation.
#[test]
fn by_the_program() {
    let (_, header, rows) = measured(3000);
    let (folder, _) = folder(&[
        ("robot.toml", UR10_LIKE),
        ("a.csv", &text(&header, &rows[..2500])),
        ("b.csv", &text(&header, &rows[2500..])),
    ]);
    let run = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
        let ran = command.current_dir(&folder).args(line.split(' ')).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (ran.status.code(), text(&ran.stdout), text(&ran.stderr))
    };
    let (code, out, error) =
        run("identify robot.toml a.csv --in-pieces --validate b.csv --out found");
    assert_eq!(code, Some(0), "{error}");
    assert!(out.contains("2500 rows of 2500 poses") && out.contains("read in pieces, "), "{out}");
    let page = std::fs::read_to_string(folder.path().join("found/report.html")).unwrap();
    assert!(page.contains("drawn by chance"));
    assert!(!out.contains("drawn by chance"), "all of them: {out}");
    let report = std::fs::read_to_string(folder.path().join("found/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["drawn"]["rows"], 2500);
    assert_eq!(report["drawn"]["flagged"], 0);
    let residuals = std::fs::read_to_string(folder.path().join("found/residuals.csv")).unwrap();
    assert_eq!(residuals.lines().count(), 2501);
    let whole = run("identify robot.toml a.csv --out whole");
    assert_eq!(whole.0, Some(0));
    let [a, b] = ["found", "whole"]
        .map(|name| Model::read(&folder.path().join(name).join("model.toml")).unwrap());
    assert!(apart(&a, &b) < 1e-2, "{}", apart(&a, &b));
    let (code, _, error) = run("identify robot.toml a.csv --in-pieces --validate a.csv");
    assert!(code == Some(2) && error.contains("2500 of 2500 rows are fitted in"), "{error}");
    let (code, _, error) = run("identify robot.toml a.csv --in-pieces --scaling printed");
    assert!(code == Some(2) && error.contains("in pieces"), "{error}");
    let (code, out, _) = run("identify robot.toml a.csv --in-pieces=never --scaling printed");
    assert!(code == Some(0) && !out.contains("in pieces"), "{out}");
    if cfg!(unix) {
        let (code, _, error) = run("identify robot.toml /dev/stdin --in-pieces");
        assert!(code == Some(2) && error.contains("read only once"), "{error}");
    }
}
