//! Effects named from every kind.

use std::fs;
use std::process::Command;

use crate::judged::{cell, read, robot};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, Diagnosis, Verdict, diagnose};
use truearm_host::model::Measurements;
use truearm_host::page::picture::{Measured, Seen, parts};
use truearm_simulate::arm::Arm;
use truearm_simulate::body::Body;
use truearm_simulate::effects::{Defect, DefectKind};
use truearm_simulate::instruments::Cell;
use truearm_simulate::rigid;

type Wanted = [(&'static str, usize)];

/// The cell's arm with an effect.
fn bent(cell: &Cell, defect: Defect) -> Arm {
    let body = Body {
        kinds: cell.kinds.clone(),
        links: cell.links.clone(),
        gear_ratios: vec![100.0; cell.kinds.len()],
        masses: Vec::new(),
        gravity: Vector3::zeros(),
        station: rigid(&Vector3::zeros(), &Vector3::zeros()),
        tool: cell.tool,
    };
    Arm { body, defects: vec![defect] }
}

fn named(cell: &Cell, wanted: &Wanted, rng: &mut ChaCha8Rng) -> Diagnosis {
    let file = |counts: &Wanted, rng: &mut ChaCha8Rng| -> Measurements {
        read(&robot(), cell, &cell.file(counts, rng))
    };
    let (data, holdout) = (file(wanted, rng), file(wanted, rng));
    diagnose(&robot(), &data, Some(&holdout), &DiagnoseOptions::default(), &|_| ()).unwrap()
}

const GAIN: DefectKind = DefectKind::JointGain { joint: 2 };

#[test]
fn a_gain_is_named_from_every_kind_and_from_several() {
    let all: [&Wanted; 10] = [
        &[("distance", 200)],
        &[("touch", 240)],
        &[("plate", 90)],
        &[("sphere", 120), ("distance", 60)],
        &[("point", 20), ("touch", 100), ("closure", 40)],
        &[("pair", 200)],
        &[("pose", 40)],
        &[("range", 200)],
        &[("inclination", 100), ("distance", 80)],
        &[("pixel", 20)],
    ];
    for (seed, wanted) in all.into_iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(40 + seed as u64);
        let mut cell = cell(&robot(), &mut rng);
        cell.bent = Some(bent(&cell, Defect { kind: GAIN, size: 1.2e-3 }));
        let found = named(&cell, wanted, &mut rng).outcome;
        let names: Vec<_> = found.effects.iter().map(|e| (e.name, e.joints.clone())).collect();
        assert_eq!(names, [("joint-gain", vec![3])], "{wanted:?}: {:?}", found.verdict);
        let held: Vec<f64> = found.gap.iter().map(|row| row.holdout_rms_sigmas.unwrap()).collect();
        let [.., before, after] = held[..] else { panic!("{held:?}") };
        assert!(after < 0.7 * before, "{wanted:?}: {held:?}");
        assert_eq!(found.verdict, Verdict::Explained, "{wanted:?}");
    }
}

#[test]
fn nothing_is_named_of_a_sound_arm() {
    let all: [&Wanted; 7] = [
        &[("distance", 150)],
        &[("touch", 200)],
        &[("point", 20), ("touch", 100)],
        &[("pair", 150)],
        &[("pose", 40)],
        &[("inclination", 80), ("range", 120)],
        &[("pixel", 12)],
    ];
    for (seed, wanted) in all.into_iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(60 + seed as u64);
        let cell = cell(&robot(), &mut rng);
        let found = named(&cell, wanted, &mut rng).outcome;
        assert!(found.effects.is_empty() && found.suspected.is_empty(), "{wanted:?}");
        assert_eq!(found.verdict, Verdict::Clean, "{wanted:?}");
    }
}

/// One kind is three times as noisy as stated: its scale is found, the name stands.
#[test]
fn a_kind_that_is_noisier_than_stated_forces_no_name() {
    let mut rng = ChaCha8Rng::seed_from_u64(70);
    let mut cell = cell(&robot(), &mut rng);
    cell.bent = Some(bent(&cell, Defect { kind: GAIN, size: 1.2e-3 }));
    let mut data = read(&robot(), &cell, &cell.file(&[("point", 25), ("touch", 150)], &mut rng));
    let touches = data.rows.iter_mut().filter(|row| row.kind.0 != 0);
    touches.for_each(|row| row.sigma /= 3.0);
    let found = diagnose(&robot(), &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
    let names: Vec<_> = found.outcome.effects.iter().map(|e| (e.name, e.joints.clone())).collect();
    assert_eq!(names, [("joint-gain", vec![3])]);
    let scale = |kind: &str| {
        let own = found.outcome.figures.kinds.iter().find(|k| k.kind == kind);
        own.unwrap().noise_scale
    };
    let ratio = scale("touch") / scale("point");
    assert!((2.0..4.5).contains(&ratio), "{ratio}");
}

/// One kind is stated thirty and a hundred times too coarse: its scale is found, the name
/// stands, a sound arm stays without one; what is said of the noise is of each kind.
#[test]
fn a_kind_stated_far_too_coarse_forces_no_name() {
    let wanted = [("distance", 100), ("touch", 90)];
    for (seed, coarse, hidden) in [(71, 100.0, true), (72, 30.0, true), (73, 30.0, false)] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut cell = cell(&robot(), &mut rng);
        cell.bent = hidden.then(|| bent(&cell, Defect { kind: GAIN, size: 1.2e-3 }));
        let mut data = read(&robot(), &cell, &cell.file(&wanted, &mut rng));
        let first = data.rows[0].kind;
        let distances = data.rows.iter_mut().filter(|row| row.kind == first);
        distances.for_each(|row| row.sigma *= coarse);
        let found = diagnose(&robot(), &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
        let out = &found.outcome;
        let names: Vec<_> = out.effects.iter().map(|e| (e.name, e.joints.clone())).collect();
        let expected = if hidden { vec![("joint-gain", vec![3])] } else { Vec::new() };
        assert_eq!(names, expected, "{coarse}");
        let scales: Vec<f64> = out.figures.kinds.iter().map(|k| k.noise_scale).collect();
        assert!((0.6..1.6).contains(&(scales[0] * coarse)), "{scales:?}");
        assert!((0.6..1.6).contains(&scales[1]), "{scales:?}");
        assert!((scales[0]..scales[1]).contains(&out.noise_scale), "{}", out.noise_scale);
    }
}

/// What an effect is named from is shown, whatever was measured.
#[test]
fn figures_show_every_kind() {
    let wanted: [&Wanted; 3] = [
        &[("distance", 200)],
        &[("touch", 240)],
        &[("point", 20), ("touch", 100), ("closure", 40)],
    ];
    for wanted in wanted {
        let mut rng = ChaCha8Rng::seed_from_u64(90);
        let mut cell = cell(&robot(), &mut rng);
        cell.bent = Some(bent(&cell, Defect { kind: GAIN, size: 1.2e-3 }));
        let data = read(&robot(), &cell, &cell.file(wanted, &mut rng));
        let found = diagnose(&robot(), &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
        let on = Measured { data: &data, rows: &found.rows, model: &found.model };
        let parts = parts(&Seen::new(on).unwrap(), &found.outcome.effects);
        let [part] = &parts[..] else { panic!("{wanted:?}: {} parts", parts.len()) };
        assert_eq!(part.points.len() + part.silent, data.rows.len(), "{wanted:?}");
        assert!(part.points.len() > data.rows.len() / 2, "{wanted:?}");
        // They follow the line: 1.2 mrad per rad, shown in mrad against degrees.
        let near = |(x, y): &(f64, f64)| {
            let on_line =
                part.curve.iter().min_by(|a, b| (a.0 - x).abs().total_cmp(&(b.0 - x).abs()));
            (on_line.unwrap().1 - y).abs()
        };
        let mut off: Vec<f64> = part.points.iter().map(near).collect();
        off.sort_by(f64::total_cmp);
        assert!(off[off.len() / 2] < 0.1, "{wanted:?}: {} mrad", off[off.len() / 2]);
        let largest = part.curve.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
        assert!(largest > 1.0, "{wanted:?}: {largest} mrad");
    }
}

/// Where geometry is all there is, nothing is said of where it disagrees: not of closures,
/// whose targets are where their points are less their residuals, and not where one
/// kind follows another.
#[test]
fn nothing_is_said_of_where_a_sound_arm_disagrees() {
    let wanted: [&Wanted; 3] = [
        &[("closure", 150)],
        &[("distance", 120), ("closure", 120)],
        &[("touch", 100), ("distance", 100), ("plate", 60)],
    ];
    for (seed, wanted) in wanted.into_iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(60 + seed as u64);
        let cell = cell(&robot(), &mut rng);
        let found = named(&cell, wanted, &mut rng).outcome;
        assert_eq!(found.verdict, Verdict::Clean, "{wanted:?}");
        assert!(found.whereabouts.is_empty(), "{wanted:?}: {:?}", found.whereabouts);
    }
}

/// What a hold-out file refers to and the training does not know is refused, with what
/// the verb can do.
#[test]
fn a_holdout_of_another_kind_is_refused_with_a_remedy() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    let cell = cell(&robot(), &mut rng);
    let mut file = |wanted: &Wanted| read(&robot(), &cell, &cell.file(wanted, &mut rng));
    let data = file(&[("distance", 120)]);
    let others = [("touch", "plane \"P0\" is unknown"), ("point", "station \"\", which no row")];
    for (kind, what) in others {
        let holdout = file(&[(kind, 20)]);
        let error = diagnose(&robot(), &data, Some(&holdout), &DiagnoseOptions::default(), &|_| ());
        let error = error.err().unwrap();
        assert!(error.to_string().contains(what), "{error}");
        let help = error.help().to_owned();
        assert!(help.starts_with("hold out rows of the kinds"), "{help}");
    }
}

/// The program takes several files, says which a row stands in, and warns once.
#[test]
fn several_files_of_a_session() {
    let mut rng = ChaCha8Rng::seed_from_u64(80);
    let cell = cell(&robot(), &mut rng);
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("robot.toml", truearm_simulate::robots::UR10_LIKE);
    write("instruments.toml", &format!("nonsense = 1\n{}", cell.stated(false)));
    write("lengths.csv", &cell.file(&[("distance", 80)], &mut rng));
    let touches = cell.file(&[("touch", 80)], &mut rng);
    // A gross error in the first touch.
    let mut lines: Vec<String> = touches.lines().map(str::to_owned).collect();
    let first: Vec<&str> = lines[1].split(',').collect();
    let q1: f64 = first[0].parse().unwrap();
    lines[1] =
        [vec![format!("{}", q1 + 3.0)], first[1..].iter().map(|c| (*c).to_owned()).collect()]
            .concat()
            .join(",");
    write("touches.csv", &(lines.join("\n") + "\n"));
    // The second time over what the first one wrote.
    for verb in ["identify", "identify", "diagnose"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
        command.current_dir(&folder).args([verb, "robot.toml", "--out", verb]);
        let out =
            command.args(["--data", "lengths.csv", "--data", "touches.csv"]).output().unwrap();
        let [said, warned] = [out.stdout, out.stderr].map(|b| String::from_utf8(b).unwrap());
        assert!(out.status.success(), "{verb}: {warned}");
        assert_eq!(warned.matches("nonsense").count(), 1, "{verb}: {warned}");
        let rows = fs::read_to_string(folder.path().join(verb).join("residuals.csv")).unwrap();
        assert!(
            rows.starts_with("row,file,line,") && rows.contains("\n81,touches.csv,2,"),
            "{rows}"
        );
        if verb == "identify" {
            assert!(said.contains("row 81 (touches.csv, line 2)"), "{said}");
        }
        let report = fs::read_to_string(folder.path().join(verb).join("report.json")).unwrap();
        assert!(report.contains("\"file\": \"touches.csv\""), "{verb}");
        let page = fs::read_to_string(folder.path().join(verb).join("report.html")).unwrap();
        assert!(page.contains("--apart-from lengths.csv --apart-from touches.csv"), "{verb}");
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    command.current_dir(&folder).args(["check", "robot.toml", "lengths.csv"]);
    let out = command.output().unwrap();
    let said = String::from_utf8(out.stdout).unwrap();
    assert_eq!(out.status.code(), Some(4), "{said}");
    assert!(said.contains("too few points, 0 beside 80 rows of other kinds"), "{said}");
    write("holes.csv", &cell.file(&[("plate", 60), ("point", 20)], &mut rng));
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    let out = command.current_dir(&folder).args(["check", "robot.toml", "holes.csv"]).output();
    let out = out.unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    write("ranges.csv", &cell.file(&[("range", 80), ("pair", 40), ("inclination", 40)], &mut rng));
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    command.current_dir(&folder).args(["diagnose", "robot.toml", "--data", "lengths.csv"]);
    let out = command.args(["--data", "ranges.csv", "--out", "turning"]).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let said = String::from_utf8(out.stdout).unwrap();
    assert!(said.contains("RMS error, standard deviations of each kind's noise"), "{said}");
    let page = fs::read_to_string(folder.path().join("turning/report.html")).unwrap();
    assert!(page.contains("standard deviations of each kind"));
}
