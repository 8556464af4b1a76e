//! Parts of the rows, merged and solved.

use std::fmt::Write as _;
use std::path::Path;

use crate::simulated::{Truth, UR10_LIKE, robot};
use assert_cmd::Command;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use truearm_host::ErrorKind;
use truearm_host::gram::{NoPart, Part, Step, accumulate, step};
use truearm_host::identify::{LambdaRule, Options, TOLERANCE_ANGLE, TOLERANCE_LENGTH, identify};
use truearm_host::model::{Measurements, Model, Robot};

pub const SIGMA: f64 = 3e-5;
/// Of a tolerance: parts against one run.
const SAME: f64 = 1e-10;

/// Header and rows of an arm seen from two stations on two markers.
pub fn measured(poses: usize) -> (Robot, String, Vec<String>) {
    let robot = robot(UR10_LIKE);
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let truth = Truth::draw(&robot, 2, 2, &mut rng);
    let text = truth.measure(poses, SIGMA, &mut rng);
    let mut lines = text.lines().map(str::to_owned);
    let header = lines.next().unwrap();
    (robot, header, lines.collect())
}

fn parse(robot: &Robot, header: &str, rows: &[String]) -> Measurements {
    let mut text = format!("{header}\n");
    rows.iter().for_each(|row| writeln!(text, "{row}").unwrap());
    Measurements::parse(Path::new("part.csv"), &text, robot).unwrap()
}

fn lambda(robot: &Robot, data: &Measurements, rule: LambdaRule) -> Model {
    let options = Options { rule, ..Options::default() };
    identify(robot, data, &options, &|_, _| ()).unwrap().model
}

/// Rounds until it is settled, by parts that go through their file.
pub fn settled(start: &Model, parts: &[Measurements]) -> Step {
    let mut state = start.clone();
    for _ in 0..20 {
        let grams = parts.iter().map(|data| accumulate(&state, data).unwrap().to_bytes());
        let mut grams = grams.map(|bytes| Part::from_bytes(&bytes).unwrap());
        let first = grams.next().unwrap();
        let sums = grams.fold(first, |sum, part| sum.plus(&part).unwrap());
        let next = step(&state, &sums).unwrap();
        if next.model.gram.as_ref().unwrap().settled {
            return next;
        }
        // As it goes from machine to machine.
        state = Model::parse(Path::new("state.toml"), &next.model.to_toml()).unwrap();
    }
    panic!("not settled")
}

/// Largest difference of a correction, in tolerances.
pub fn apart(a: &Model, b: &Model) -> f64 {
    let units =
        [TOLERANCE_ANGLE, TOLERANCE_LENGTH, TOLERANCE_ANGLE, TOLERANCE_LENGTH, TOLERANCE_ANGLE];
    let both = a.corrections.iter().zip(&b.corrections);
    let off = both.flat_map(|(a, b)| {
        let (a, b) = (a.to_array(), b.to_array());
        (0..5).map(move |k| (a[k] - b[k]).abs() / units[k])
    });
    off.fold(0.0, f64::max)
}

#[test]
fn sixty_four_parts_are_one_run() {
    let (robot, header, mut rows) = measured(400);
    // Decimetres off: none of these counts.
    for row in rows.iter_mut().step_by(71) {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        cells[6] = cells[6].replace('.', "9.");
        *row = cells.join(",");
    }
    let start = lambda(&robot, &parse(&robot, &header, &rows[..90]), LambdaRule::default());
    let whole = [parse(&robot, &header, &rows)];
    let one = settled(&start, &whole);
    assert!(one.model.gram.as_ref().unwrap().flagged >= rows.len() / 71);
    let mut shuffled = rows.clone();
    shuffled.shuffle(&mut ChaCha8Rng::seed_from_u64(3));
    for (count, rows) in [(7, &rows), (64, &rows), (64, &shuffled)] {
        let parts: Vec<Measurements> =
            rows.chunks(rows.len().div_ceil(count)).map(|r| parse(&robot, &header, r)).collect();
        let many = settled(&start, &parts);
        assert!(apart(&one.model, &many.model) < SAME, "{}", apart(&one.model, &many.model));
        let [a, b] = [&one, &many].map(|s| s.cross_validated_rms_mm.unwrap());
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
        assert_eq!(one.model.gram.as_ref().unwrap().k, many.model.gram.as_ref().unwrap().k);
        assert_eq!(one.model.covered, many.model.covered);
        let frames = (one.model.frame_translation - many.model.frame_translation).norm();
        assert!(frames < 1e-12, "{frames}");
    }
}

#[test]
fn the_whole_is_what_identify_finds() {
    let (robot, header, rows) = measured(300);
    let data = parse(&robot, &header, &rows);
    let start = lambda(&robot, &parse(&robot, &header, &rows[..80]), LambdaRule::default());
    let found = settled(&start, std::slice::from_ref(&data));
    let own = found.model.provenance.lambda;
    let free = lambda(&robot, &data, LambdaRule::default());
    let chosen = free.provenance.lambda;
    assert!((own / chosen).ln().abs() < 0.1, "{own} {chosen}");
    let like = lambda(&robot, &data, LambdaRule::Fixed(own));
    // A step of 1e-4 may be the last of `identify`.
    assert!(apart(&found.model, &like) < 1e-4, "{}", apart(&found.model, &like));
    for (a, b) in found.model.uncertainties.iter().zip(&free.uncertainties) {
        for (a, b) in a.to_array().iter().zip(b.to_array()) {
            assert!((a / b - 1.0).abs() < 0.03, "{a} {b}");
        }
    }
    let off = (found.model.frame_translation - like.frame_translation).norm();
    assert!(off < 1e-9, "{off}");
    let [a, b] = [&found.model, &like].map(|m| m.provenance.cross_validated_rms_mm);
    assert!((a / b - 1.0).abs() < 0.05, "{a} {b}");
}

/// A given lambda stays, and what bends the arm is fitted with it.
#[test]
fn terms_and_rules_of_the_start() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases");
    let case = folder.join("case_009");
    let robot = Robot::read(&case.join("robot.toml")).unwrap();
    let data = Measurements::read(&case.join("measurements.csv"), &robot).unwrap();
    let found = truearm_host::diagnose::diagnose(
        &robot,
        &data,
        None,
        &truearm_host::diagnose::DiagnoseOptions::default(),
        &|_| (),
    );
    let model = found.unwrap().model;
    let size = |model: &Model| model.terms[0].coefficient();
    assert!(!model.terms.is_empty());
    let mut start = model.clone();
    *start.terms[0].coefficient_mut() *= 0.5;
    start.provenance.lambda_rule = LambdaRule::Fixed(0.0).name().to_owned();
    let again = settled(&start, &[data]).model;
    assert!((size(&again) / size(&model) - 1.0).abs() < 1e-3, "{} {}", size(&again), size(&model));
    assert_eq!(again.provenance.lambda, start.provenance.lambda);
}

#[test]
fn parts_of_other_states_and_files() {
    let (robot, header, rows) = measured(60);
    let data = parse(&robot, &header, &rows);
    let start = lambda(&robot, &data, LambdaRule::MaximumAPosteriori);
    let part = accumulate(&start, &data).unwrap();
    let next = step(&start, &part).unwrap().model;
    let later = accumulate(&next, &data).unwrap();
    assert_eq!(part.clone().plus(&later).unwrap_err().kind(), ErrorKind::OtherArm);
    assert_eq!(step(&next, &part).unwrap_err().kind(), ErrorKind::OtherArm);
    // A copy is the same state, however often it is copied; an edited one is another.
    let mut copy = next.clone();
    for _ in 0..3 {
        copy = Model::parse(Path::new("copy.toml"), &copy.to_toml()).unwrap();
        accumulate(&copy, &data).unwrap().plus(&later).unwrap();
    }
    let edited = copy.to_toml().replacen("\nbeta_deg = ", "\nbeta_deg = 1", 1);
    let edited = Model::parse(Path::new("edited.toml"), &edited).unwrap();
    let error = accumulate(&edited, &data).unwrap().plus(&later).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::OtherArm);
    let bytes = later.to_bytes();
    assert_eq!(Part::from_bytes(&bytes).unwrap(), later);
    assert_eq!(Part::from_bytes(b"q1_deg,x_mm\n"), Err(NoPart::Magic));
    for cut in 12..bytes.len().min(4000) {
        assert!(Part::from_bytes(&bytes[..cut]).is_err(), "{cut}");
    }
    for at in (0..bytes.len()).step_by(97) {
        let mut changed = bytes.clone();
        changed[at] ^= 0x10;
        assert!(Part::from_bytes(&changed).is_err(), "{at}");
    }
    let mut other = bytes;
    other[12] = 3;
    assert_eq!(Part::from_bytes(&other), Err(NoPart::Version(3)));
}

/// From a start of few rows, tolerances off: the scale of the residuals is that of the end, and
/// with it what counts and how sure the arm is.
#[test]
fn a_start_far_off_leaves_nothing_behind() {
    let (robot, header, rows) = measured(300);
    let data = parse(&robot, &header, &rows);
    let near = lambda(&robot, &parse(&robot, &header, &rows[..200]), LambdaRule::default());
    let far = lambda(&robot, &parse(&robot, &header, &rows[..18]), LambdaRule::default());
    let [a, b] = [near, far].map(|start| settled(&start, std::slice::from_ref(&data)).model);
    let [k, l] = [&a, &b].map(|model| model.gram.as_ref().unwrap().k);
    assert!((k / l - 1.0).abs() < 0.02, "{k} {l}");
    assert!(apart(&a, &b) < 1e-2, "{}", apart(&a, &b));
    for (a, b) in a.uncertainties.iter().zip(&b.uncertainties) {
        for (a, b) in a.to_array().iter().zip(b.to_array()) {
            assert!((a / b - 1.0).abs() < 0.05, "{a} {b}");
        }
    }
}

/// More than a quarter of the rows beyond what the others say: `identify` refuses, and so does this.
#[test]
fn rows_that_contradict_are_refused() {
    let (robot, header, mut rows) = measured(200);
    let start = lambda(&robot, &parse(&robot, &header, &rows[..80]), LambdaRule::default());
    for row in rows.iter_mut().step_by(3) {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        cells[6] = cells[6].replace('.', "9.");
        *row = cells.join(",");
    }
    let data = parse(&robot, &header, &rows);
    let mut state = start;
    let error = (0..20).find_map(|_| {
        let part = accumulate(&state, &data).unwrap();
        match step(&state, &part) {
            Ok(next) => {
                assert!(!next.model.gram.as_ref().unwrap().settled);
                state = next.model;
                None
            }
            Err(error) => Some(error),
        }
    });
    assert!(error.unwrap().to_string().contains("contradict"));
}

/// What a hand changes of a state makes it another one, wherever in the file it stands.
#[test]
fn edited_places_are_another_state() {
    let (robot, header, rows) = measured(60);
    let data = parse(&robot, &header, &rows);
    let start = lambda(&robot, &data, LambdaRule::MaximumAPosteriori);
    let state = step(&start, &accumulate(&start, &data).unwrap()).unwrap().model;
    let part = accumulate(&state, &data).unwrap();
    let edits: [fn(&mut Model); 4] = [
        |model| model.stations[0].1.translation.x += 1e-4,
        |model| model.markers[0].1.x += 1e-4,
        |model| model.robot.sigma *= 2.0,
        |model| model.gram.as_mut().unwrap().targets[0].y += 1e-4,
    ];
    for edit in edits {
        let mut other = state.clone();
        edit(&mut other);
        let error = accumulate(&other, &data).unwrap().plus(&part).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::OtherArm);
    }
}

/// The bytes with these eight in place of what stood there, and a checksum that fits.
fn forged(bytes: &[u8], at: usize, eight: [u8; 8]) -> Vec<u8> {
    let mut changed = bytes.to_vec();
    changed[at..at + 8].copy_from_slice(&eight);
    let body = changed.len() - 4;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&changed[..body]);
    changed[body..].copy_from_slice(&crc.to_le_bytes());
    changed
}

/// A checksum that fits is no proof: what is no number is refused, counts do not overflow, and
/// parts of an arm with other unknowns are an error.
#[test]
fn forged_parts_are_errors() {
    let (robot, header, rows) = measured(60);
    let data = parse(&robot, &header, &rows);
    let start = lambda(&robot, &data, LambdaRule::MaximumAPosteriori);
    let start = step(&start, &accumulate(&start, &data).unwrap()).unwrap().model;
    let part = accumulate(&start, &data).unwrap();
    let bytes = part.to_bytes();
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        // In the first fold: its precision, and the first number of its triangle.
        for at in [96, 104] {
            let changed = forged(&bytes, at, value.to_le_bytes());
            assert_eq!(Part::from_bytes(&changed), Err(NoPart::Damaged), "{at}: {value}");
        }
    }
    let below = forged(&bytes, 96, (-1.0_f64).to_le_bytes());
    assert_eq!(Part::from_bytes(&below), Err(NoPart::Damaged));
    // Files, rows, poses, flagged; equations and rows of the first fold.
    for at in [48, 56, 64, 72, 80, 88] {
        let changed = Part::from_bytes(&forged(&bytes, at, u64::MAX.to_le_bytes())).unwrap();
        assert_eq!(changed.clone().plus(&changed).unwrap_err().kind(), ErrorKind::Usage);
        let both = changed.plus(&part).unwrap();
        let _ = step(&start, &both);
    }
    let other = Truth::draw(&robot, 1, 1, &mut ChaCha8Rng::seed_from_u64(5));
    let text = other.measure(60, SIGMA, &mut ChaCha8Rng::seed_from_u64(5));
    let data = Measurements::parse(Path::new("other.csv"), &text, &robot).unwrap();
    let fewer = lambda(&robot, &data, LambdaRule::MaximumAPosteriori);
    let fewer = accumulate(&fewer, &data).unwrap().to_bytes();
    let digest = bytes[16..24].try_into().unwrap();
    let fewer = Part::from_bytes(&forged(&fewer, 16, digest)).unwrap();
    assert_eq!(step(&start, &fewer).unwrap_err().kind(), ErrorKind::OtherArm);
}

/// A part is known in whatever tree of merges it is; what the layout before wrote is read.
#[test]
fn a_part_counts_once_in_a_tree() {
    let (robot, header, rows) = measured(60);
    let data = parse(&robot, &header, &rows);
    let start = lambda(&robot, &data, LambdaRule::MaximumAPosteriori);
    let of = |rows: &[String]| accumulate(&start, &parse(&robot, &header, rows)).unwrap();
    let parts: Vec<Part> = rows.chunks(rows.len() / 4).take(4).map(of).collect();
    let read = |part: Part| Part::from_bytes(&part.to_bytes()).unwrap();
    let [left, right] = [0, 2].map(|k| read(parts[k].clone().plus(&parts[k + 1]).unwrap()));
    let all = read(left.clone().plus(&right).unwrap());
    assert_eq!(all.sources().len(), 4);
    for twice in parts.iter().chain([&left, &right, &all]) {
        let error = all.clone().plus(twice).unwrap_err();
        assert!(error.to_string().contains("count twice"), "{error}");
    }
    // Version 1: the same without the digests.
    let old = |part: &Part| {
        let mut bytes = part.to_bytes();
        bytes[12] = 1;
        bytes.truncate(bytes.len() - 12 - 8 * if part.files() > 1 { 2 } else { 0 });
        bytes.extend([0; 4]);
        let state = bytes[16..24].try_into().unwrap();
        Part::from_bytes(&forged(&bytes, 16, state)).unwrap()
    };
    assert_eq!(old(&parts[0]), parts[0]);
    assert!(all.plus(&old(&parts[0])).is_err());
    // What it was merged of is not known: it is a part of its own.
    assert_eq!(old(&left).sources().len(), 1);
    assert!(old(&left).plus(&right).is_ok());
}

/// Digests that are not there, twice or out of order are refused.
#[test]
fn digests_are_not_believed() {
    let (robot, header, rows) = measured(60);
    let data = parse(&robot, &header, &rows);
    let start = lambda(&robot, &data, LambdaRule::MaximumAPosteriori);
    let of = |rows: &[String]| accumulate(&start, &parse(&robot, &header, rows)).unwrap();
    let both = of(&rows[..30]).plus(&of(&rows[30..])).unwrap();
    let bytes = both.to_bytes();
    let count = bytes.len() - 4 - 3 * 8;
    for size in [0, 1, 3, 1 << 40, u64::MAX] {
        let changed = forged(&bytes, count, u64::to_le_bytes(size));
        assert_eq!(Part::from_bytes(&changed), Err(NoPart::Damaged), "{size}");
    }
    for (at, digest) in [(count + 8, u64::MAX), (count + 16, 0), (count + 16, both.sources()[0])] {
        let changed = forged(&bytes, at, digest.to_le_bytes());
        assert_eq!(Part::from_bytes(&changed), Err(NoPart::Damaged), "{digest}");
    }
}

/// Sizes that are not there are refused before anything is made of them.
#[test]
fn sizes_are_not_believed() {
    let (robot, header, rows) = measured(60);
    let data = parse(&robot, &header, &rows);
    let start = lambda(&robot, &data, LambdaRule::MaximumAPosteriori);
    let bytes = accumulate(&start, &data).unwrap().to_bytes();
    for at in [24, 32, 40] {
        for size in [0, 1, 16_384, 16_385, u64::MAX] {
            let changed = forged(&bytes, at, u64::to_le_bytes(size));
            assert_eq!(Part::from_bytes(&changed), Err(NoPart::Damaged), "{at}: {size}");
        }
    }
}

#[test]
fn what_is_no_part_is_named() {
    let (robot, header, rows) = measured(60);
    let data = parse(&robot, &header, &rows);
    let start = lambda(&robot, &data, LambdaRule::MaximumAPosteriori);
    let station = data.stations[0].clone();
    let renamed: Vec<String> = rows.iter().map(|row| row.replace(&station, "elsewhere")).collect();
    let error = accumulate(&start, &parse(&robot, &header, &renamed)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::UnknownStation);
    assert!(error.to_string().contains("elsewhere") && error.help().contains("identify"));
    let kinds = format!("{header},kind,anchor,distance_mm");
    let mut mixed = rows.clone();
    mixed.iter_mut().for_each(|row| row.push_str(",,,"));
    let last = mixed.last_mut().unwrap();
    last.truncate(last.len() - 3);
    last.push_str(",distance,wire,1000");
    let error = accumulate(&start, &parse(&robot, &kinds, &mixed)).unwrap_err();
    assert!(error.to_string().contains("distance"), "{error}");
}

#[test]
fn by_the_program() {
    let (_, header, rows) = measured(60);
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, rows: &[String]| {
        let text = format!("{header}\n{}\n", rows.join("\n"));
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    std::fs::write(folder.path().join("robot.toml"), UR10_LIKE).unwrap();
    write("a.csv", &rows[..50]);
    write("b.csv", &rows[50..]);
    let run = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
        let ran = command.current_dir(&folder).args(line.split(' ')).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (ran.status.code(), text(&ran.stdout), text(&ran.stderr))
    };
    let done = |line: &str| {
        let (code, out, error) = run(line);
        assert_eq!(code, Some(0), "{line}: {error}");
        out
    };
    done("identify robot.toml a.csv --out start");
    std::fs::copy(folder.path().join("start/model.toml"), folder.path().join("state.toml"))
        .unwrap();
    let mut said = String::new();
    for _ in 0..20 {
        done("gram add state.toml a.csv --out a.gram");
        done("gram add state.toml b.csv --out b.gram");
        assert!(done("gram merge b.gram a.gram --out all.gram").contains("2 files"));
        let (code, _, error) = run("gram merge all.gram a.gram --out all.gram");
        assert!(code == Some(2) && error.contains("is read"), "{code:?} {error}");
        said = done("gram step state.toml all.gram --out state.toml");
        if said.contains("this is the identified arm") {
            break;
        }
        assert!(said.contains("not settled"), "{said}");
    }
    assert!(said.contains("this is the identified arm"), "{said}");
    done("pack state.toml --marker M0 --out arm.bin");
    // Rows count once, whatever the file is called that says them.
    std::fs::copy(folder.path().join("a.gram"), folder.path().join("c.gram")).unwrap();
    for line in [
        "gram merge a.gram b.gram c.gram",
        "gram add state.toml a.csv a.csv",
        "gram merge all.gram c.gram",
        "gram merge b.gram all.gram",
    ] {
        let (code, _, error) = run(&format!("{line} --out twice.gram"));
        assert!(code == Some(2) && error.contains("count twice"), "{line}: {code:?} {error}");
    }
    let (code, _, error) = run("gram merge a.gram state.toml --out all.gram");
    assert!(code == Some(1) && error.contains("state.toml: no .gram file"), "{error}");
    let (code, _, error) = run("gram add state.toml a.csv --out robot.toml");
    assert!(code == Some(1) && error.contains("--force"), "{error}");
    let (code, _, error) = run("gram step start/model.toml a.gram --out next.toml");
    assert!(code == Some(1) && error.contains("not accumulated at this state"), "{error}");
    let (code, _, error) = run("gram add state.toml a.csv b.csv --out a.csv");
    assert!(code == Some(2) && error.contains("written over"), "{error}");
}
