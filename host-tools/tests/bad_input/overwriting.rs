//! What verbs may write over: what they wrote themselves; with --force what others
//! did; never what they read.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::{read, run, table_8, write};

/// The paper's points, the model they give, a path and poses.
fn folder() -> TempDir {
    let folder = table_8();
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --out .").0, 0);
    let rows = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,time_s\n10,-80,70,-60,-80,20,1\n";
    fs::write(folder.path().join("path.csv"), rows).unwrap();
    fs::write(folder.path().join("points.csv"), "x_mm,y_mm,z_mm\n-400,-200,300\n").unwrap();
    let table = "alpha_deg,a_mm,theta_offset_deg,d_mm\n0,100,0,10\n90,200,0,20\n";
    fs::write(folder.path().join("dh.csv"), table).unwrap();
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/urdf/ur5e.urdf");
    fs::copy(urdf, folder.path().join("arm.urdf")).unwrap();
    folder
}

/// Verbs that write one file: the line without it, and the files that are read.
const VERBS: [(&str, &[&str]); 12] = [
    ("fk model.toml path.csv --out", &["model.toml", "path.csv"]),
    ("ik model.toml points.csv --out", &["model.toml", "points.csv"]),
    (
        "compensate model.toml path.csv --extrapolate --format csv --out",
        &["model.toml", "path.csv"],
    ),
    ("compensate model.toml path.csv --extrapolate --format urscript --out", &["path.csv"]),
    ("compensate model.toml path.csv --extrapolate --format ros2 --out", &["model.toml"]),
    ("import measurements.csv --robot robot.toml --out", &["measurements.csv", "robot.toml"]),
    ("robot --dh modified dh.csv --out", &["dh.csv"]),
    ("robot --urdf arm.urdf --out", &["arm.urdf"]),
    ("export model.toml --mdh", &["model.toml"]),
    ("pack model.toml --format bin --out", &["model.toml"]),
    (
        "plan robot.toml --limits -9:9,-9:9,-9:9,-9:9,-9:9,-9:9 --candidates 60 --poses 14 --out",
        &["robot.toml"],
    ),
    (
        "verify model.toml --limits -9:9,-9:9,-9:9,-9:9,-9:9,-9:9 --poses 2 --test-poses",
        &["model.toml"],
    ),
];

/// Whether files may be written is asked before anything is computed: of two points nothing
/// can be.
#[test]
fn a_folder_is_asked_for_first() {
    let folder = table_8();
    let text = read(&folder, "measurements.csv");
    write(&folder, "m.csv", &text.lines().take(3).map(|l| format!("{l}\n")).collect::<String>());
    std::fs::create_dir(folder.path().join("out")).unwrap();
    write(&folder, "out/residuals.csv", "somebody's own\n");
    for verb in ["identify", "diagnose"] {
        let (status, said) = run(&folder, &format!("{verb} robot.toml m.csv --out other"));
        assert!(status == 1 && said.contains("6 equations"), "{said}");
        let (status, said) = run(&folder, &format!("{verb} robot.toml m.csv --out out"));
        assert!(status == 1 && said.contains("not as truearm wrote it"), "{verb}: {said}");
    }
    write(&folder, "file", "");
    let (status, said) = run(&folder, "identify robot.toml m.csv --out file/out");
    assert!(status == 2 && said.contains("no folder to write into"), "{said}");
}

#[test]
fn inputs_stay_even_with_force() {
    let folder = folder();
    for (line, inputs) in VERBS {
        for input in inputs {
            let before = fs::read(folder.path().join(input)).unwrap();
            // The same file by another name is the same file.
            for name in [(*input).to_owned(), format!("./{input}"), link(&folder, input)] {
                let (status, said) = run(&folder, &format!("{line} {name} --force"));
                assert!(status == 2 && said.contains("is read"), "{line} {name}: {status} {said}");
                let after = fs::read(folder.path().join(input)).unwrap();
                assert!(before == after, "{line} {name}");
            }
        }
    }
    // A folder's files, and the import.toml beside an output.
    for line in [
        "identify model.toml measurements.csv --out . --force",
        "identify robot.toml residuals.csv --out . --force",
        "diagnose robot.toml measurements.csv --holdout residuals.csv --out . --force",
    ] {
        let (status, said) = run(&folder, line);
        assert!(status == 2 && said.contains("is read"), "{line}: {status} {said}");
    }
}

/// Another name of a file.
fn link(folder: &TempDir, name: &str) -> String {
    let link = format!("link-{name}");
    #[cfg(unix)]
    let _ = std::os::unix::fs::symlink(name, folder.path().join(&link));
    #[cfg(not(unix))]
    return name.to_owned();
    #[cfg(unix)]
    link
}

#[test]
fn what_others_wrote_needs_force() {
    let folder = folder();
    let measured = fs::read_to_string(folder.path().join("measurements.csv")).unwrap();
    for (line, _) in VERBS {
        let status = |name: &str| run(&folder, &format!("{line} {name}"));
        let read = |name: &str| fs::read(folder.path().join(name)).unwrap_or_default();
        for stood in ["mine\n", "", &measured.replace("0.1", "0.2")] {
            let _ = fs::remove_file(folder.path().join("import.toml"));
            fs::write(folder.path().join("out.csv"), stood).unwrap();
            let (code, said) = status("out.csv");
            let own = line.starts_with("pack") && stood.is_empty();
            if !own {
                assert!(code == 1 && said.contains("--force"), "{line}: {code} {said}");
                assert!(read("out.csv") == stood.as_bytes(), "{line} over {stood:?}");
            }
            let (code, said) = status("out.csv --force");
            assert!(code == 0, "{line}: {said}");
            assert!(read("out.csv") != stood.as_bytes(), "{line}");
        }
        let (code, said) = status("out.csv");
        assert!(code == 0, "what the verb wrote may be written again: {line}: {said}");
        fs::remove_file(folder.path().join("out.csv")).unwrap();
    }
}

/// A program of a template may be anything: it is known by its first line.
#[test]
fn programs_of_templates() {
    let folder = folder();
    let template = "header = \"DEF path()\\n\"\nrow = \"PTP {q1_deg}\\n\"\n";
    fs::write(folder.path().join("mine.toml"), template).unwrap();
    let line = "compensate model.toml path.csv --extrapolate --template mine.toml --out told.src";
    assert_eq!(run(&folder, line).0, 0);
    assert_eq!(run(&folder, line).0, 0);
    fs::write(folder.path().join("told.src"), "DEF other()\n").unwrap();
    assert_eq!(run(&folder, line).0, 1);
    let over = line.replace("told.src", "mine.toml --force");
    assert_eq!(run(&folder, &over).0, 2);
}

/// Pages are known by how they begin.
#[test]
fn pages_of_others_stay() {
    let folder = folder();
    let limits = ["-9:9"; 6].join(",");
    let line = format!("plan robot.toml --limits {limits} --candidates 60 --poses 14 --out p.csv");
    let (status, said) = run(&folder, &format!("{line} --html robot.toml --force"));
    assert!(status == 2 && said.contains("is read"), "{status} {said}");
    fs::write(folder.path().join("plan.html"), "<p>mine</p>").unwrap();
    let (status, said) = run(&folder, &format!("{line} --html plan.html"));
    assert!(status == 1 && said.contains("plan.html"), "{status} {said}");
    assert_eq!(run(&folder, &format!("{line} --html plan.html --force")).0, 0);
    assert_eq!(run(&folder, &format!("{line} --html plan.html")).0, 0);
}

/// Pictures and tables of a report folder are known by the report beside them.
#[test]
fn reports_of_others_stay() {
    let folder = folder();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("c")).unwrap();
    file("c/methods.svg", "<svg/>");
    let line = "compare robot.toml measurements.csv --out c";
    let (status, said) = run(&folder, line);
    assert!(status == 1 && said.contains("methods.svg"), "{status} {said}");
    assert_eq!(run(&folder, &format!("{line} --force")).0, 0);
    assert_eq!(run(&folder, line).0, 0);
    let rows = fs::read_to_string(folder.path().join("measurements.csv")).unwrap();
    let commanded = (1..=6).fold(rows, |t, j| t.replace(&format!("q{j}_"), &format!("cmd{j}_")));
    file("commanded.csv", &commanded);
    fs::create_dir(folder.path().join("v")).unwrap();
    file("v/errors.csv", "mine\n");
    let line = "verify model.toml commanded.csv --out v";
    let (status, said) = run(&folder, line);
    assert!(status == 1 && said.contains("errors.csv"), "{status} {said}");
    assert_eq!(run(&folder, &format!("{line} --force")).0, 0);
    assert_eq!(run(&folder, line).0, 0);
}
