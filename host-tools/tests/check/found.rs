//! Gross mistakes are found, named and mended; sound files are left in peace.
//! The long form is `cargo xtask study check`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::mistakes::{Mistake, Outcome, SCARA, Session, drawn, judged, read};
use crate::simulated::robot;
use assert_cmd::Command;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::Value;
use truearm_host::check::{Verdict, check};
use truearm_host::model::{Measurements, Robot};
use truearm_simulate::robots;

fn arm(seed: u64) -> Robot {
    let arms = [robots::ALL.as_slice(), &[SCARA]].concat();
    robot(arms[seed as usize % arms.len()])
}

fn session(seed: u64) -> (Session, ChaCha8Rng) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (Session::draw(&arm(seed), &mut rng), rng)
}

/// Of each seed the mistakes and what became of them.
fn outcomes(seeds: std::ops::Range<u64>, count: usize) -> Vec<(String, Outcome)> {
    let of = |seed: u64| {
        let (clean, mut rng) = session(seed);
        let mut typed = clean.clone();
        let mut made: Vec<Mistake> = Vec::new();
        while made.len() < count {
            let mistake = drawn(&typed, &mut rng);
            let same = |m: &Mistake| std::mem::discriminant(m) == std::mem::discriminant(&mistake);
            if !made.iter().any(same) {
                typed.make(&mistake);
                made.push(mistake);
            }
        }
        let finding = typed.checked();
        let outcome = judged(&clean, &typed, &made, &finding);
        (format!("seed {seed}: {made:?} -> {outcome:?}: {:?}", finding.said), outcome)
    };
    seeds.into_par_iter().map(of).collect()
}

fn told(outcomes: &[(String, Outcome)]) -> usize {
    let good = |o: &Outcome| matches!(o, Outcome::Named | Outcome::Equivalent | Outcome::Absorbed);
    outcomes.iter().filter(|(_, o)| !good(o)).for_each(|(words, _)| println!("{words}"));
    outcomes.iter().filter(|(_, o)| good(o)).count()
}

#[test]
fn single_mistakes_are_told() {
    let outcomes = outcomes(100..156, 1);
    assert!(told(&outcomes) >= 55, "of {}", outcomes.len());
    let named = outcomes.iter().filter(|(_, o)| *o == Outcome::Named).count();
    assert!(named * 3 >= outcomes.len() * 2, "only {named} by name");
}

#[test]
fn two_at_once_are_told() {
    let outcomes = outcomes(200..220, 2);
    assert!(told(&outcomes) >= 18, "of {}", outcomes.len());
}

/// The angles of a robot file are radians; nothing but the arm tells.
#[test]
fn a_robot_in_radians_is_told() {
    let said: Vec<(bool, String)> = (400..424_u64)
        .into_par_iter()
        .map(|seed| {
            let (clean, _) = session(seed);
            let mut typed = clean.clone();
            typed.make(&Mistake::RobotInRadians);
            let finding = typed.checked();
            let outcome = judged(&clean, &typed, &[Mistake::RobotInRadians], &finding);
            let good = matches!(outcome, Outcome::Named | Outcome::Equivalent);
            (good, format!("seed {seed}: {outcome:?}: {:?}", finding.said))
        })
        .collect();
    let missed: Vec<&String> = said.iter().filter(|(told, _)| !told).map(|(_, s)| s).collect();
    assert!(missed.len() <= 1, "{missed:#?}");
}

/// In few rows two that are far off may be the right ones; in more they are slips.
#[test]
fn two_rows_of_few_are_no_slips() {
    for (rows, sound) in [(8, false), (12, false), (16, true), (30, true)] {
        let (mut typed, _) = session(3);
        typed.joints.truncate(rows);
        typed.points.truncate(rows);
        typed.points[4][0] += 40.0;
        typed.points[6][1] -= 25.0;
        let finding = typed.checked();
        assert_eq!(finding.verdict == Verdict::Sound, sound, "{rows}: {:?}", finding.stray);
    }
}

/// A robot file in metres is one in all its lengths.
#[test]
fn all_lengths_of_a_robot_in_metres_are_mended() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let text = fs::read_to_string(shipped("ur10-ipa/robot.toml")).unwrap();
    let mut table: toml_edit::DocumentMut = text.parse().unwrap();
    let metres = |item: &mut toml_edit::Item| {
        let of = |value: &toml_edit::Value| {
            value.as_float().unwrap_or_else(|| value.as_integer().unwrap() as f64) * 1e-3
        };
        let value = item.as_value_mut().unwrap();
        *value = match value.as_array() {
            Some(array) => array.iter().map(of).collect(),
            None => of(value).into(),
        };
    };
    metres(&mut table["measurement_sigma_mm"]);
    metres(&mut table["tool"]["xyz_mm"]);
    for joint in table["joints"].as_array_of_tables_mut().unwrap().iter_mut() {
        for key in ["a_mm", "d_mm"] {
            metres(&mut joint[key]);
        }
    }
    for link in table["links"].as_array_of_tables_mut().unwrap().iter_mut() {
        metres(&mut link["com_mm"]);
    }
    fs::write(at("robot.toml"), table.to_string()).unwrap();
    fs::copy(shipped("ur10-ipa/series-b/measurements.csv"), at("m.csv")).unwrap();
    fs::write(at("instruments.toml"), "[[anchors]]\nlabel = \"A\"\nxyz_mm = [1.0, 2.0, 3.0]\n")
        .unwrap();
    let line = ["check", "robot.toml", "m.csv", "--fix", "mended"];
    let mut command = Command::cargo_bin("truearm").unwrap();
    assert_eq!(command.current_dir(&folder).args(line).output().unwrap().status.code(), Some(3));
    let read = |text: &str| Robot::parse(Path::new("robot.toml"), text).unwrap();
    let (mended, drawn) =
        (read(&fs::read_to_string(at("mended/robot.toml")).unwrap()), read(&text));
    assert!((mended.sigma - drawn.sigma).abs() < 1e-12);
    assert!((mended.tool - drawn.tool).norm() < 1e-12);
    for (mended, drawn) in mended.links.iter().zip(&drawn.links) {
        assert!((mended.com - drawn.com).norm() < 1e-12, "{mended:?} {drawn:?}");
    }
    // What is stated of instruments is beside the copies, too.
    let books = ["instruments.toml", "mended/instruments.toml"].map(|n| fs::read(at(n)).unwrap());
    assert_eq!(books[0], books[1]);
}

#[test]
fn sound_sessions_raise_no_alarm() {
    (300..335_u64).into_par_iter().for_each(|seed| {
        let finding = session(seed).0.checked();
        assert_eq!(finding.verdict, Verdict::Sound, "seed {seed}: {:?}", finding.said);
        assert!(finding.changes.is_empty());
        // The tracker stands anywhere: the zero of joint 1 cannot be seen.
        assert!(!finding.absorbed.is_empty(), "seed {seed}");
    });
}

/// Two parallel axes and few rows: base, tool and lengths hardly tell each other
/// apart, and a fit that has not come to rest looks wrong.
#[test]
fn sound_scaras_raise_no_alarm() {
    let alarms: Vec<String> = (0..80_u64)
        .into_par_iter()
        .filter_map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(9000 + seed);
            let mut sound = Session::draw(&robot(SCARA), &mut rng);
            let rows = 30 + seed as usize % 31;
            sound.joints.truncate(rows);
            sound.points.truncate(rows);
            let finding = sound.checked();
            let alarm = finding.verdict != Verdict::Sound;
            alarm.then(|| format!("seed {seed}: {:?}", finding.said))
        })
        .collect();
    assert!(alarms.is_empty(), "{}", alarms.join("\n"));
}

/// Seeds, how much of a file is wrong, and what.
fn parts() -> Vec<(u64, f64, Mistake)> {
    let mistakes = [
        Mistake::Sense(1),
        Mistake::Swapped(1, 2),
        Mistake::Radians,
        Mistake::PointsIn(1000.0),
        Mistake::Mirrored(1),
        Mistake::Mirrored(2),
    ];
    let mut all = Vec::new();
    for seed in [0, 3] {
        for part in [0.1, 0.2, 0.3, 0.4] {
            all.extend(mistakes.iter().map(|mistake| (seed, part, mistake.clone())));
        }
    }
    all
}

/// A part of the rows that is wrong is never called sound; one block of them is
/// named, and one mistake in it mended.
#[test]
fn mistakes_in_some_rows_are_told() {
    let said: Vec<(bool, String)> = parts()
        .into_par_iter()
        .map(|(seed, part, mistake)| {
            let (mut typed, _) = session(seed);
            let (n, first) = (typed.points.len(), typed.points.len() as f64 * (1.0 - part));
            let first = first.round() as usize;
            typed.make_in(first..n, &mistake);
            let finding = typed.checked();
            let name = format!("seed {seed}, {mistake:?} in rows {} to {n}", first + 1);
            assert_ne!(finding.verdict, Verdict::Sound, "{name}");
            let Some(stray) = finding.stray.clone().filter(|stray| stray.many) else {
                return (false, format!("{name}: {:?}", finding.said));
            };
            let mut told = stray.rows.contains(&format!("to {n}")) || n - first < 3;
            if finding.verdict == Verdict::Mendable {
                let mended = typed.mended(&finding);
                let (robot, data) = read(&mended.robot, &mended.measurements);
                told &= check(&robot, &data).verdict == Verdict::Sound;
            }
            // Another sign than that of z, or too few rows to tell, is left to the user.
            let plain = !matches!(mistake, Mistake::Mirrored(1)) && n - first >= 4;
            told &= !plain || finding.verdict == Verdict::Mendable;
            (told, format!("{name}: {stray}; {:?}", finding.said))
        })
        .collect();
    let missed: Vec<&String> = said.iter().filter(|(told, _)| !told).map(|(_, s)| s).collect();
    missed.iter().for_each(|words| println!("{words}"));
    assert!(missed.len() * 20 <= said.len(), "{} of {}", missed.len(), said.len());
}

/// Single rows here and there have no mistake in common; a few of them are in any file.
#[test]
fn scattered_rows_are_counted() {
    for seed in 0..6 {
        let (mut typed, _) = session(seed);
        let n = typed.points.len();
        let spoiled: Vec<usize> = (3..n).step_by(7).collect();
        let mut few = typed.clone();
        for row in spoiled.iter().copied() {
            typed.points[row][0] += 30.0 + row as f64;
        }
        let finding = typed.checked();
        assert_eq!(finding.verdict, Verdict::NotUnderstood, "seed {seed}: {:?}", finding.said);
        let stray = finding.stray.unwrap();
        assert_eq!((stray.count, stray.of), (spoiled.len(), n), "seed {seed}");
        assert!(stray.rows.starts_with("4, 11, 18"), "{}", stray.rows);
        assert!(stray.others_mm < 1.0 && stray.off_mm > 30.0, "{stray}");

        few.points[3][0] += 30.0;
        let finding = few.checked();
        assert_eq!(finding.verdict, Verdict::Sound, "seed {seed}: {:?}", finding.said);
        assert_eq!(finding.stray.unwrap().rows, "4");
    }
}

/// With half of the rows elsewhere the fit lies between the halves: no file of which
/// coordinates known to hundredths disagree by centimetres is sound.
#[test]
fn halves_that_disagree_are_not_sound() {
    for seed in 0..2 {
        for (from, shift) in [(2, 20.0), (3, 40.0)] {
            let (mut typed, _) = session(seed);
            let n = typed.points.len();
            typed.points[n / from..].iter_mut().for_each(|point| point[1] += shift);
            let finding = typed.checked();
            assert_ne!(finding.verdict, Verdict::Sound, "seed {seed}: {}", finding.rms_after);
        }
    }
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

#[test]
fn real_arms_and_hidden_effects_raise_no_alarm() {
    let mut sets = vec![
        ("ur10-ipa".to_owned(), "ur10-ipa/series-b".to_owned()),
        ("ur10-ipa".to_owned(), "ur10-ipa/series-c".to_owned()),
        ("seed-table-8".to_owned(), "seed-table-8".to_owned()),
    ];
    for case in 1..=18 {
        let folder = format!("hidden-effects/cases/case_{case:03}");
        sets.push((folder.clone(), folder));
    }
    for (arm, rows) in sets {
        let robot = Robot::read(&shipped(&arm).join("robot.toml")).unwrap();
        let data = Measurements::read(&shipped(&rows).join("measurements.csv"), &robot).unwrap();
        let finding = check(&robot, &data);
        assert_eq!(finding.verdict, Verdict::Sound, "{rows}: {:?}", finding.said);
    }
}

#[test]
fn another_arm_is_not_understood() {
    let (mut rows, _) = session(0);
    let (other, _) = session(3);
    assert_eq!(rows.kinds, other.kinds, "two arms of six joints");
    rows.table = other.table;
    let finding = rows.checked();
    assert_eq!(finding.verdict, Verdict::NotUnderstood, "{:?}", finding.said);
    assert!(finding.changes.is_empty() && finding.rms_before > 0.02);
}

#[test]
fn what_is_mended_and_what_is_not_touched() {
    let (mut typed, _) = session(0);
    typed.make(&Mistake::Sense(2));
    typed.make(&Mistake::Number(3, 3, 150.0));
    let rows = format!("# by hand\n{}", typed.rows_text());
    let robot_text = format!("# my arm\n{}", typed.robot_text());
    let (robot, data) = read(&robot_text, &rows);
    let finding = check(&robot, &data);
    let names: Vec<_> = finding.said.iter().map(|said| (said.what, said.joint)).collect();
    assert!(names.contains(&("joint-sense", Some(3))), "{names:?}");
    let texts = ((&robot, robot_text.as_str()), (&data, rows.as_str()));
    let mended = truearm_host::check::mend::mend(texts.0, texts.1, &finding).unwrap();

    // One line of comment more; in every row the third cell has the other sign.
    let (comment, left) = mended.measurements.split_once('\n').unwrap();
    assert!(comment.starts_with("# truearm check: joint 3"), "{comment}");
    let pairs: Vec<_> = rows.lines().zip(left.lines()).collect();
    assert_eq!(pairs.len(), rows.lines().count());
    for (before, after) in &pairs[2..] {
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let (before, after) = (cells(before), cells(after));
        for (column, (before, after)) in before.iter().zip(&after).enumerate() {
            if column == 2 {
                assert_eq!(before.trim_start_matches('-'), after.trim_start_matches('-'));
                assert_ne!(before, after);
            } else {
                assert_eq!(before, after);
            }
        }
    }
    // Only the length is another one.
    let (comment, left) = mended.robot.split_once('\n').unwrap();
    assert!(comment.starts_with("# truearm check: d of joint"), "{comment}");
    let changed: Vec<_> = robot_text.lines().zip(left.lines()).filter(|(a, b)| a != b).collect();
    assert_eq!(changed.len(), 1, "{changed:?}");
    assert!(changed[0].1.starts_with("d_mm = ") && changed[0].1.ends_with(" # along z"));
    let (robot, data) = read(&mended.robot, &mended.measurements);
    assert_eq!(check(&robot, &data).verdict, Verdict::Sound);
}

/// Runs `truearm check`; status, standard output, standard error.
fn program(folder: &Path, args: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::cargo_bin("truearm").unwrap();
    let out = command.current_dir(folder).env("COLUMNS", "1000").args(args).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (out.status.code(), text(&out.stdout), text(&out.stderr))
}

fn written(session: &Session) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), session.robot_text()).unwrap();
    fs::write(folder.path().join("measurements.csv"), session.rows_text()).unwrap();
    folder
}

const FILES: [&str; 2] = ["robot.toml", "measurements.csv"];

#[test]
fn exit_status_and_files() {
    let (sound, _) = session(2);
    let folder = written(&sound);
    let line = ["check", FILES[0], FILES[1], "--fix", "fixed"];
    let (status, said, _) = program(folder.path(), &line);
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("no gross mistake"), "{said}");
    for name in FILES {
        let read = |path: PathBuf| fs::read(path).unwrap();
        let (before, after) = (folder.path().join(name), folder.path().join("fixed").join(name));
        assert_eq!(read(before), read(after), "unchanged");
    }

    let mut wrong = sound.clone();
    wrong.make(&Mistake::Zero(1, 90.0));
    let folder = written(&wrong);
    let (status, said, _) = program(folder.path(), &[&line[..], &["--json"]].concat());
    assert_eq!(status, Some(3), "{said}");
    let report: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(report["schema"], "truearm-check-1");
    assert_eq!(report["verdict"], "mendable");
    assert_eq!(report["changes"][0]["what"], "joint-zero");
    assert_eq!(report["changes"][0]["joint"], 2);
    let number = |key: &str| report[key].as_f64().unwrap();
    assert!(number("rms_before_mm") > 20.0 * number("rms_after_mm") && number("margin") > 2.0);
    let fixed = folder.path().join("fixed");
    assert_eq!(program(&fixed, &["check", FILES[0], FILES[1]]).0, Some(0));
    let (status, _, error) = program(&fixed, &["check", FILES[0], FILES[1], "--fix", "."]);
    assert_eq!(status, Some(2));
    assert!(error.contains("is read"), "{error}");

    let (other, _) = session(3);
    wrong.table = other.table;
    let folder = written(&wrong);
    let (status, said, _) = program(folder.path(), &line);
    assert_eq!(status, Some(4), "{said}");
    assert!(said.contains("not understood") && said.contains("wrote nothing"), "{said}");
    assert!(!folder.path().join("fixed").exists());
}

/// What somebody else wrote into the folder stays, without --force.
#[test]
fn fixed_files_of_others_stay() {
    let (mut typed, _) = session(2);
    typed.make(&Mistake::Sense(1));
    let folder = written(&typed);
    let target = folder.path().join("mine");
    fs::create_dir(&target).unwrap();
    let line = ["check", FILES[0], FILES[1], "--fix", "mine"];
    for name in FILES {
        fs::write(target.join(name), "mine\n").unwrap();
        let (status, _, error) = program(folder.path(), &line);
        assert!(status == Some(1) && error.contains("--force"), "{error}");
        assert_eq!(fs::read(target.join(name)).unwrap(), b"mine\n", "{name}");
        let other = if name == FILES[0] { FILES[1] } else { FILES[0] };
        assert!(!target.join(other).exists(), "nothing is written beside it");
        let (status, _, error) = program(folder.path(), &[&line[..], &["--force"]].concat());
        assert_eq!(status, Some(3), "{error}");
        let (status, _, error) = program(folder.path(), &line);
        assert_eq!(status, Some(3), "its own may be written again: {error}");
        fs::remove_dir_all(&target).unwrap();
        fs::create_dir(&target).unwrap();
    }
    let before = FILES.map(|name| fs::read(folder.path().join(name)).unwrap());
    for extra in [&[][..], &["--force"]] {
        let line = [&["check", FILES[0], FILES[1], "--fix", "."], extra].concat();
        let (status, _, error) = program(folder.path(), &line);
        assert!(status == Some(2) && error.contains("is read"), "{error}");
    }
    assert_eq!(before, FILES.map(|name| fs::read(folder.path().join(name)).unwrap()));
}

/// A mistake in a part of the rows, and a single large correction, are told there.
#[test]
fn fits_tell_of_rows_and_single_corrections() {
    let words =
        |error: &str| error.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ");
    let (mut typed, _) = session(0);
    let n = typed.points.len();
    typed.make_in(n * 6 / 10..n, &Mistake::Sense(1));
    let folder = written(&typed);
    let (status, said, _) = program(folder.path(), &["check", FILES[0], FILES[1], "--json"]);
    let report: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(status, Some(3), "{said}");
    let rows = format!("{} to {n}", n * 6 / 10 + 1);
    assert_eq!(report["changes"][0]["rows"], rows.as_str());
    assert_eq!(report["stray"]["many"], true);
    for verb in ["identify", "diagnose"] {
        let (_, _, error) = program(folder.path(), &[verb, FILES[0], FILES[1]]);
        let name = format!("in rows {rows}: joint 2 counts the other way");
        assert!(words(&error).contains(&name), "{verb}: {error}");
    }

    let (mut typed, _) = session(0);
    typed.make(&Mistake::Number(4, 2, 5.0));
    let folder = written(&typed);
    for verb in ["identify", "diagnose", "compare"] {
        let (_, _, error) = program(folder.path(), &[verb, FILES[0], FILES[1]]);
        assert!(words(&error).contains("the zero of joint 5 is off"), "{verb}: {error}");
    }
}

/// Where a fit fails or ends far off, the mistake is named there as well.
#[test]
fn fits_ask() {
    for (mistake, name) in [
        (Mistake::Sense(1), "joint 2 counts the other way"),
        (Mistake::Zero(2, 6.0), "the zero of joint 3 is off"),
        (Mistake::Radians, "the joint angles are in rad"),
    ] {
        let (mut typed, _) = session(2);
        typed.make(&mistake);
        let folder = written(&typed);
        for verb in ["identify", "diagnose"] {
            let (_, _, error) = program(folder.path(), &[verb, FILES[0], FILES[1]]);
            let words = error.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(words.contains(name), "{verb} {mistake:?}: {words}");
            assert!(words.contains("truearm check robot.toml measurements.csv --fix"), "{words}");
            if mistake == Mistake::Radians {
                let (warning, error) = (words.find("are they radians?"), words.find("Error:"));
                assert!(warning.is_some() && error.is_none_or(|e| warning < Some(e)), "{words}");
            }
        }
    }
}
