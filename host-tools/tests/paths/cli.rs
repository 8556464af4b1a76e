//! Paths as their user meets them: the real UR10 from measurements to corrected joints
//! with the program alone, the languages it writes, and what it says to bad input.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

/// Status and what was said, with line breaks undone.
fn says(folder: &TempDir, line: &[&str]) -> (i32, String) {
    let mut command = Command::cargo_bin("truearm").unwrap();
    let ran = command.current_dir(folder).args(line).env("COLUMNS", "1000").output().unwrap();
    let text = String::from_utf8([ran.stdout, ran.stderr].concat()).unwrap();
    assert!(!text.contains("panicked"), "{text}");
    let text = text.replace('│', " ");
    (ran.status.code().unwrap(), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn run(folder: &TempDir, line: &str) -> String {
    let (status, text) = says(folder, &line.split(' ').collect::<Vec<_>>());
    assert_eq!(status, 0, "{line}: {text}");
    text
}

fn read(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).unwrap()
}

/// Rows by the names of their columns.
fn table(folder: &TempDir, name: &str) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(folder.path().join(name)).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

fn numbers<const N: usize>(row: &HashMap<String, String>, names: [&str; N]) -> [f64; N] {
    names.map(|name| row[name].parse().unwrap())
}

const POINT: [&str; 3] = ["x_mm", "y_mm", "z_mm"];
const JOINTS: [&str; 6] = ["q1_deg", "q2_deg", "q3_deg", "q4_deg", "q5_deg", "q6_deg"];

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Diagnosed on two rows of three, judged on the third: `fk` sees the points that
/// were measured, `compensate` brings the tool to where it was commanded.
#[test]
fn ur10_from_measurements_to_corrected_joints() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(data("ur10-ipa/robot.toml"), folder.path().join("robot.toml")).unwrap();
    let all = fs::read_to_string(data("ur10-ipa/series-c/measurements.csv")).unwrap();
    let (header, rows) = all.split_once('\n').unwrap();
    let part = |third: bool| -> String {
        let rows = rows.lines().enumerate().filter(|(i, _)| (i % 3 == 2) == third);
        std::iter::once(header).chain(rows.map(|(_, row)| row)).map(|l| format!("{l}\n")).collect()
    };
    fs::write(folder.path().join("train.csv"), part(false)).unwrap();
    fs::write(folder.path().join("check.csv"), part(true)).unwrap();
    run(&folder, "diagnose robot.toml train.csv --out out");
    let report: Value = serde_json::from_str(&read(&folder, "out/report.json")).unwrap();
    let stated = report["gap"].as_array().unwrap().last().unwrap()["cross_validated_rms_mm"]
        .as_f64()
        .unwrap();

    run(&folder, "fk out/model.toml check.csv --station C --out seen.csv");
    let (seen, measured) = (table(&folder, "seen.csv"), table(&folder, "check.csv"));
    assert_eq!((seen.len(), measured.len()), (500, 500));
    let squares: Vec<f64> = seen
        .iter()
        .zip(&measured)
        .map(|(a, b)| apart(numbers(a, POINT), numbers(b, POINT)).powi(2))
        .collect();
    let mean = squares.iter().sum::<f64>() / 500.0;
    let spread = squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / 499.0;
    let (rms, error) = (mean.sqrt(), (spread / 500.0).sqrt() / (2.0 * mean.sqrt()));
    println!("500 rows: {rms:.4} mm, stated {stated:.4} mm, standard error {error:.4} mm");
    assert!(rms <= 1.05 * stated + 2.0 * error, "{rms} mm where {stated} mm are stated");

    let line = "compensate out/model.toml check.csv --from joints --extrapolate --out told.csv";
    println!("{}", run(&folder, line));
    met(&folder, "out/model.toml", "check.csv", "told.csv");
    let said = run(&folder, &format!("{line} --json --force"));
    let said: Value = serde_json::from_str(&said[said.find('{').unwrap()..]).unwrap();
    let of = |key: &str, what: &str| said[key][what].as_f64().unwrap();
    as_documented([of("before", "rms_mm"), of("left", "max_mm"), rms, stated]);

    // As many terms as a controller takes: in its numbers as well.
    run(&folder, "identify robot.toml train.csv --out rigid");
    let line = "compensate rigid/model.toml check.csv --from joints --extrapolate --out";
    run(&folder, &format!("{line} double.csv"));
    run(&folder, &format!("{line} single.csv --f32"));
    met(&folder, "rigid/model.toml", "check.csv", "double.csv");
    met(&folder, "rigid/model.toml", "check.csv", "single.csv");
    let poses = |name: &str| {
        run(&folder, &format!("fk rigid/model.toml {name} --out f.csv"));
        table(&folder, "f.csv").iter().map(|row| numbers(row, POINT)).collect::<Vec<_>>()
    };
    let (double, single) = (poses("double.csv"), poses("single.csv"));
    let most = double.iter().zip(single).map(|(a, b)| apart(*a, b)).fold(0.0, f64::max);
    println!("f32 and f64: {:.3} um apart", most * 1e3);
    assert!(most < 5e-3, "{most} mm");
}

/// The figures at the head of docs/paths.md are those of this test, to 3 %.
fn as_documented(found: [f64; 4]) {
    let page = include_str!("../../../docs/paths.md");
    let (_, rest) = page.split_once("On 500 rows of UR10 series C").unwrap();
    let paragraph = rest.split("\n\n").next().unwrap();
    let words: Vec<&str> = paragraph.split_whitespace().collect();
    let figures = words.windows(2).filter(|w| w[1].trim_end_matches(['.', ',']) == "mm");
    let said: Vec<f64> = figures.map(|w| w[0].parse().unwrap()).collect();
    assert_eq!(said.len(), found.len(), "{paragraph}");
    for (said, found) in said.iter().zip(found) {
        assert!((said / found - 1.0).abs() < 0.03, "{said} mm in {paragraph}\n{found} mm found");
    }
}

/// The tool at the joints that were told is where it was commanded, within what is
/// stated; and no joint was moved by more than 0.03 rad.
fn met(folder: &TempDir, model: &str, commanded: &str, told: &str) {
    run(folder, &format!("fk {model} {told} --out real.csv"));
    run(folder, &format!("fk {model} {commanded} --nominal --out wanted.csv"));
    let (real, wanted) = (table(folder, "real.csv"), table(folder, "wanted.csv"));
    let (told, commanded) = (table(folder, told), table(folder, commanded));
    assert_eq!([real.len(), wanted.len(), told.len()], [commanded.len(); 3]);
    for (i, row) in told.iter().enumerate() {
        let [left] = numbers(row, ["left_mm"]);
        let missed = apart(numbers(&real[i], POINT), numbers(&wanted[i], POINT));
        assert!(missed <= left, "row {i}: {missed} mm, {left} mm stated");
        for (q, c) in numbers(&commanded[i], JOINTS).iter().zip(numbers(row, JOINTS)) {
            assert!((c - q).to_radians().abs() <= 0.03, "row {i}: {q} -> {c}");
        }
        assert_eq!(row["goal_x_mm"], commanded[i]["goal_x_mm"]);
    }
}

const ROWS: &str = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,time_s,name\n\
    10,-80,70,-60,-80,20,0.5,\"a, b\"\n11,-81,71,-61,-81,21,2.25,c\n";

/// A folder with a model of the paper's points, and a path.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["robot.toml", "measurements.csv"] {
        fs::copy(data("seed-table-8").join(name), folder.path().join(name)).unwrap();
    }
    run(&folder, "identify robot.toml measurements.csv --out .");
    fs::write(folder.path().join("path.csv"), ROWS).unwrap();
    folder
}

#[test]
fn languages() {
    let folder = folder();
    let line = "compensate model.toml path.csv --extrapolate --out";
    run(&folder, &format!("{line} told.csv"));
    let told: Vec<[f64; 6]> =
        table(&folder, "told.csv").iter().map(|row| numbers(row, JOINTS)).collect();
    let near = |text: &str, degrees: f64| {
        let value: f64 = text.trim().parse().unwrap();
        assert!((value.to_degrees() - degrees).abs() < 1e-6, "{text} rad, {degrees} degrees");
    };

    run(&folder, &format!("{line} told.script --move movel"));
    let script = read(&folder, "told.script");
    let moves: Vec<&str> = script.lines().filter(|l| l.starts_with("  movel([")).collect();
    assert_eq!(moves.len(), 2, "{script}");
    for (text, joints) in moves.iter().zip(&told) {
        let list = text.split_once('[').unwrap().1.split_once(']').unwrap().0;
        assert_eq!(list.split(',').count(), 6);
        list.split(',').zip(joints).for_each(|(x, q)| near(x, *q));
    }

    run(&folder, &format!("{line} told.yaml --joint-names a,b,c,d,e,f"));
    let yaml = read(&folder, "told.yaml");
    assert!(yaml.starts_with("joint_names: [\"a\", \"b\", \"c\", \"d\", \"e\", \"f\"]\npoints:\n"));
    for (text, joints) in yaml.lines().filter(|l| l.starts_with("- positions: [")).zip(&told) {
        let list = text.split_once('[').unwrap().1.trim_end_matches(']');
        list.split(',').zip(joints).for_each(|(x, q)| near(x, *q));
    }
    assert!(yaml.contains("{sec: 0, nanosec: 500000000}"), "{yaml}");
    assert!(yaml.ends_with("{sec: 2, nanosec: 250000000}\n"), "{yaml}");

    let template = "header = \"DEF path() ; {rows} rows {{\\n\"\nseparator = \",\\n\"\n\
        row = '{row}: {q1_deg:.3} {q6_rad:.2} {name} {time_s:.2} {z_mm:.1}'\nfooter = \"\\nEND\"\n";
    fs::write(folder.path().join("mine.toml"), template).unwrap();
    run(&folder, &format!("{line} told.src --template mine.toml"));
    let text = read(&folder, "told.src");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!((lines[0], lines[3]), ("DEF path() ; 2 rows {", "END"));
    let first = format!("1: {:.3} {:.2} a, b 0.50 ", told[0][0], told[0][5].to_radians());
    assert!(lines[1].starts_with(&first) && lines[1].ends_with(','), "{text}");
    assert!(!lines[2].ends_with(','), "{text}");
}

/// The templates of docs/paths.md fill: the joints of every row stand in them.
#[test]
fn documented_templates() {
    let folder = folder();
    let line = "compensate model.toml path.csv --extrapolate --out";
    run(&folder, &format!("{line} told.csv"));
    let page = include_str!("../../../docs/paths.md");
    let blocks: Vec<&str> =
        page.split("```toml\n").skip(1).map(|rest| rest.split_once("```").unwrap().0).collect();
    assert_eq!(blocks.len(), 2, "KRL and RAPID");
    for block in blocks {
        fs::write(folder.path().join("t.toml"), block).unwrap();
        run(&folder, &format!("{line} told.txt --template t.toml --force"));
        let program = read(&folder, "told.txt");
        for row in table(&folder, "told.csv") {
            for q in numbers(&row, JOINTS) {
                assert!(program.contains(&format!("{q:.4}")), "{q} in {program}");
            }
        }
        assert_eq!(program.matches("{").count(), program.matches("}").count());
    }
}

/// Of which file each is refused, with which exit status and which words.
#[test]
fn bad_input() {
    let folder = folder();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let pose = "x_mm,y_mm,z_mm,qx,qy,qz,qw\n300,200,300,0,0,0,1\n";
    let limited = read(&folder, "model.toml").replacen(
        "[[joints]]",
        "[[joints]]\nlimits_deg = [-5.0, 5.0]",
        1,
    );
    let cases: &[(&str, &str, &str, i32, &str)] = &[
        ("compensate model.toml ROWS", "", "", 1, "the file is empty"),
        ("compensate model.toml ROWS", "a,b\n1,2\n", "", 1, "no joints and no points of the tool"),
        ("compensate model.toml ROWS", ROWS, "q6_deg=q6", 1, "missing column q6_deg"),
        ("fk model.toml ROWS", ROWS, "q6_deg=q7_deg", 1, "missing column q6_deg"),
        (
            "compensate model.toml ROWS",
            ROWS,
            "time_s=x_mm",
            1,
            "say which of them is the command with --from",
        ),
        ("compensate model.toml ROWS", ROWS, "-80,70=NaN,70", 1, "NaN is not a finite number"),
        ("compensate model.toml ROWS", ROWS, "10,=ten,", 1, "\"ten\" is not a number"),
        ("compensate model.toml ROWS", ROWS, ",c=", 1, "7 cells where the header has 8"),
        (
            "compensate limited.toml ROWS",
            ROWS,
            "",
            1,
            "joint 1 at 10 degrees is outside its limits, -5 to 5",
        ),
        ("compensate model.toml ROWS", ROWS, "time_s=left_mm", 1, "compensated before"),
        ("compensate model.toml ROWS", pose, "y_mm=why_mm", 1, "missing column y_mm"),
        ("compensate model.toml ROWS", pose, "qz=q", 1, "orientation needs all of qx, qy, qz, qw"),
        ("compensate model.toml ROWS", pose, "0,1=0,2", 1, "quaternion of length 2.000"),
        ("compensate model.toml ROWS", pose, "0,1=0,", 1, "column qw: empty cell"),
        (
            "compensate model.toml ROWS",
            "x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n300,200,300,0,180,0\n",
            "",
            1,
            "orientations that are not read: rx_deg, ry_deg, rz_deg",
        ),
        ("ik model.toml ROWS", pose, "qx,qy,qz,qw=A,B,C,D", 1, "not read: A, B, C"),
        ("compensate model.toml ROWS", pose, "300,200=,200", 1, "no coordinate of a pose"),
        ("ik model.toml ROWS", pose, "300,200=inf,200", 1, "no coordinate of a pose"),
        ("ik model.toml ROWS", pose, "qx,qy=roll_deg,qy", 1, "orientation needs all of"),
        (
            "ik model.toml ROWS",
            pose,
            "300,200=3000,200",
            3,
            "1 row not reached, without joints: line 2:",
        ),
        ("compensate model.toml ROWS", pose, "300,200=3000,200", 3, "1 row not reached"),
        (
            "compensate model.toml ROWS --format urscript",
            pose,
            "300,200=3000,200",
            1,
            "line 2 is not reached",
        ),
        (
            "compensate model.toml ROWS --task pose",
            ROWS,
            "",
            2,
            "task pose, and how the last frame of this arm is turned was not identified help: \
             points alone were measured: take --task position",
        ),
        ("compensate model.toml ROWS --start 1,2", ROWS, "", 2, "give 6 joint values"),
        (
            "compensate model.toml ROWS --marker ball",
            ROWS,
            "",
            1,
            "marker \"ball\" is unknown to the model",
        ),
        ("compensate model.toml ROWS --format ros2", ROWS, "2.25=0.5", 1, "the time does not grow"),
        ("compensate model.toml ROWS --format ros2", ROWS, "time_s=t", 1, "--every SECONDS"),
        ("compensate model.toml ROWS --format ros2 --every 0", ROWS, "", 2, "--every 0"),
        ("compensate model.toml ROWS --every 1", ROWS, "", 2, "--every is for a ROS 2 trajectory"),
        ("compensate model.toml ROWS --move movel", ROWS, "", 2, "--move is for a URScript"),
        ("compensate model.toml ROWS --format ros2 --move movel", ROWS, "", 2, "--move is for"),
        (
            "compensate model.toml ROWS --format ros2 --joint-names a,b",
            ROWS,
            "",
            2,
            "--joint-names of 2 joints",
        ),
        (
            "compensate model.toml ROWS --template bad1.toml",
            ROWS,
            "",
            1,
            "bad1.toml: row: nothing is called {q9_deg}",
        ),
        (
            "compensate model.toml ROWS --template bad2.toml",
            ROWS,
            "",
            1,
            "bad2.toml: row: a brace that belongs to none",
        ),
        ("compensate model.toml ROWS --template bad3.toml", ROWS, "", 1, "unknown field `rows`"),
        ("compensate robot.toml ROWS", ROWS, "", 1, "give a model.toml as written by"),
        ("compensate ROWS model.toml", ROWS, "", 1, "are the arguments swapped?"),
        ("fk ROWS robot.toml", ROWS, "", 1, "are the arguments swapped?"),
        (
            "fk robot.toml ROWS --station C",
            ROWS,
            "",
            1,
            "station \"C\" is unknown to the model, which knows none",
        ),
        (
            "fk model.toml ROWS",
            ROWS,
            "time_s,name=x_mm,input_x_mm",
            1,
            "column input_x_mm stands there already",
        ),
    ];
    file("limited.toml", &limited);
    file("bad1.toml", "row = '{q9_deg}'");
    file("bad2.toml", "row = '{q1_deg'");
    file("bad3.toml", "rows = '{q1_deg}'");
    for (line, text, change, status, words) in cases {
        let text = match change.split_once('=') {
            Some((from, to)) => text.replacen(from, to, 1),
            None => (*text).to_owned(),
        };
        file("rows.csv", &text);
        let _ = fs::remove_file(folder.path().join("out.csv"));
        let line = format!("{} --out out.csv", line.replace("ROWS", "rows.csv"));
        let (found, said) = says(&folder, &line.split(' ').collect::<Vec<_>>());
        assert!(
            found == *status && said.contains(words),
            "{line}\n{text}\n{found}: {said}\n{words}"
        );
        // What was refused leaves no file; what was found wrong does.
        assert_eq!(folder.path().join("out.csv").exists(), *status == 3, "{line}");
    }
    let (status, said) =
        says(&folder, &["compensate", "model.toml", "path.csv", "--out", "told.txt"]);
    assert!(status == 2 && said.contains("end it in .csv, .script or .yaml"), "{said}");
}
