//! report.html: every verb writes one that needs nothing else, in which every row
//! of the data is drawn and nothing that a user wrote is markup.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::markup::Element;
use serde_json::Value;
use tempfile::TempDir;

fn data(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

/// Runs a line in a folder; standard output.
fn run(folder: &TempDir, line: &str, status: i32) -> String {
    let line = line.replace("LIMITS", &["-120:120"; 6].join(","));
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    let ran = command.current_dir(folder).args(line.split(' ')).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    assert_eq!(ran.status.code(), Some(status), "{line}: {}", text(ran.stderr));
    text(ran.stdout)
}

/// The paper's points, and the same as commanded ones.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["robot.toml", "measurements.csv"] {
        fs::copy(data("seed-table-8").join(name), folder.path().join(name)).unwrap();
    }
    let rows = fs::read_to_string(folder.path().join("measurements.csv")).unwrap();
    let commanded = (1..=6).fold(rows, |t, j| t.replace(&format!("q{j}_"), &format!("cmd{j}_")));
    fs::write(folder.path().join("c.csv"), &commanded).unwrap();
    fs::write(folder.path().join("off.csv"), commanded).unwrap();
    folder
}

fn page(folder: &TempDir, file: &str) -> (String, Element) {
    let text = fs::read_to_string(folder.path().join(file)).unwrap();
    let parsed = Element::parse(&text);
    (text, parsed)
}

/// What holds of every page.
fn sound(folder: &TempDir, file: &str) -> Element {
    let (text, root) = page(folder, file);
    let begin = "<!DOCTYPE html>\n<!-- truearm report -->\n<html";
    assert!(text.starts_with(begin), "{file}");
    let addresses = text.matches("http").count();
    let policy = text.matches("http-equiv").count();
    let spaces = text.matches("xmlns=\"http://www.w3.org/1999/xhtml\"").count();
    assert_eq!(addresses, policy + spaces, "{file} has an address");
    assert!(!text.contains("NaN") && !text.contains("inf "), "{file}");
    assert_eq!(root.all("script").len(), 1, "{file}");
    assert!(root.all("link").is_empty() && root.all("img").is_empty());
    for name in ["src", "onclick", "onerror", "onload"] {
        assert!(!text.contains(&format!(" {name}=")), "{file}: {name}");
    }
    let verdict =
        root.all("p").into_iter().find(|p| p.get("class").is_some_and(|c| c.contains("verdict")));
    assert!(verdict.unwrap().text.ends_with('.'), "{file}");
    for series in root.all("g").into_iter().filter(|g| g.get("data-marks").is_some()) {
        let (said, drawn) = series.marks();
        assert!(said == drawn && said > 0, "{file}: {said} marks said, {drawn} drawn: {series:?}");
    }
    root
}

/// Rows of the view that can be turned.
fn view(root: &Element) -> Value {
    let view = root.all("div").into_iter().find_map(|d| d.get("data-rows")).unwrap();
    serde_json::from_str(view).unwrap()
}

fn marks(root: &Element, figure: &str) -> Vec<usize> {
    let figure = root.id(&format!("figure-{figure}")).unwrap_or_else(|| panic!("no {figure}"));
    let groups = figure.all("g").into_iter().filter(|g| g.get("data-marks").is_some());
    groups.map(|g| g.marks().1).collect()
}

#[test]
fn every_verb_writes_one() {
    let folder = folder();
    let plan = "plan robot.toml --poses 14 --candidates 100 --limits LIMITS --out p.csv";
    for (line, status, file) in [
        ("identify robot.toml measurements.csv --out i --figures", 0, "i/report.html"),
        ("diagnose robot.toml measurements.csv --out d --figures", 0, "d/report.html"),
        ("compare robot.toml measurements.csv --out c", 0, "c/report.html"),
        ("verify i/model.toml c.csv --tolerance-mm 0.1 --out v --figures", 3, "v/report.html"),
        (&format!("{plan} --html p/report.html --figures"), 0, "p/report.html"),
    ] {
        run(&folder, line, status);
        let root = sound(&folder, file);
        for figure in root.all("figure") {
            let name = figure.get("id").unwrap().strip_prefix("figure-").unwrap();
            let svg = folder.path().join(file).with_file_name(format!("{name}.svg"));
            let text =
                fs::read_to_string(&svg).unwrap_or_else(|e| panic!("{}: {e}", svg.display()));
            let drawn = Element::parse(&text);
            let count =
                |e: &Element| e.all("g").iter().filter(|g| g.get("data-marks").is_some()).count();
            assert_eq!(count(&drawn), count(figure), "{}", svg.display());
        }
    }
}

#[test]
fn marks_are_the_data() {
    let folder = folder();
    run(&folder, "identify robot.toml measurements.csv --out .", 0);
    let root = sound(&folder, "report.html");
    // Nominal and identified; the latter held out as well.
    assert_eq!(marks(&root, "staircase"), [2, 1]);
    // Of 18 rows two are flagged; before and after in three views.
    assert_eq!(marks(&root, "workspace"), [16; 6]);
    // Of six joints those that the rows tell rather than the tolerances.
    assert_eq!(marks(&root, "corrections"), [5, 1, 4, 3, 3]);
    let view = view(&root);
    for key in ["points", "before", "after", "rows"] {
        assert_eq!(view[key].as_array().unwrap().len(), 16, "{key}");
    }
    let flagged = root.id("flagged").unwrap();
    assert_eq!(flagged.all("tr").len(), 3);
    run(&folder, "verify model.toml c.csv --before off.csv --out v", 0);
    let root = sound(&folder, "v/report.html");
    assert_eq!(marks(&root, "errors"), [18; 4]);
    let plan =
        "plan robot.toml --poses 14 --candidates 100 --limits LIMITS --out p.csv --html p.html";
    run(&folder, plan, 0);
    let root = sound(&folder, "p.html");
    assert_eq!(marks(&root, "workspace"), [14; 3]);
    assert_eq!(marks(&root, "joints"), [6, 14 * 6]);
}

/// A joint with a wave, found: the figure shows every row against the cycle.
#[test]
fn an_effect_is_shown_against_what_gave_it_away() {
    let folder = tempfile::tempdir().unwrap();
    let cases = data("hidden-effects/cases");
    let mut shown = 0;
    for case in ["case_001", "case_010", "case_015"] {
        for name in ["robot.toml", "measurements.csv", "holdout.csv"] {
            fs::copy(cases.join(case).join(name), folder.path().join(name)).unwrap();
        }
        let said = run(
            &folder,
            "diagnose robot.toml measurements.csv --holdout holdout.csv --out out --force",
            0,
        );
        assert!(said.lines().rev().nth(1).unwrap().starts_with("next, "), "{said}");
        assert!(said.lines().last().unwrap().starts_with("  truearm "), "{said}");
        let root = sound(&folder, "out/report.html");
        let json = fs::read_to_string(folder.path().join("out/report.json")).unwrap();
        let report: Value = serde_json::from_str(&json).unwrap();
        let gap = report["gap"].as_array().unwrap().len();
        assert_eq!(marks(&root, "staircase"), [gap, gap - 1, gap]);
        let verdict = report["verdict"].as_str().unwrap();
        let first = root.all("p")[0].text.to_lowercase();
        assert!(first.starts_with(verdict), "{verdict}: {first}");
        for effect in report["effects"].as_array().unwrap() {
            let name = effect["name"].as_str().unwrap();
            if name == "outliers" {
                continue;
            }
            let joints = effect["joints"].as_array().unwrap();
            // Of a coupling the joint that is moved.
            let first = if name == "joint-coupling" { 1 } else { 0 };
            for joint in &joints[first..] {
                let rows = marks(&root, &format!("{name}-{joint}"))[0];
                let flagged = report["outlier_rows"].as_array().unwrap().len();
                let all = report["rows"].as_u64().unwrap() as usize - flagged;
                assert!(rows <= all && 2 * rows > all, "{name}: {rows} of {all}");
                shown += 1;
            }
        }
    }
    assert!(shown >= 4, "{shown} effects shown");
}

#[test]
fn what_users_write_is_text() {
    let folder = folder();
    let evil = "<script>alert(1)</script>\"'&]]>";
    let robot = fs::read_to_string(folder.path().join("robot.toml")).unwrap();
    let name = robot.lines().find(|l| l.starts_with("name")).unwrap();
    let robot = robot.replace(name, &format!("name = '''{evil}'''"));
    fs::write(folder.path().join("robot.toml"), robot).unwrap();
    for file in ["measurements.csv", "c.csv"] {
        let rows = fs::read_to_string(folder.path().join(file)).unwrap();
        let mut lines = rows.lines();
        let mut out = format!("{},station,<b>x</b>\n", lines.next().unwrap());
        lines.for_each(|l| out += &format!("{l},\"<i>{}</i>\",<u>\n", evil.replace('"', "\"\"")));
        fs::write(folder.path().join(file), out).unwrap();
    }
    let plan =
        "plan robot.toml --poses 14 --candidates 100 --limits LIMITS --out p.csv --html p.html";
    for (line, file) in [
        ("identify robot.toml measurements.csv --out i --figures", "i/report.html"),
        ("diagnose robot.toml measurements.csv --out d", "d/report.html"),
        ("compare robot.toml measurements.csv --out c", "c/report.html"),
        ("verify i/model.toml c.csv --out v", "v/report.html"),
        (plan, "p.html"),
    ] {
        run(&folder, line, 0);
        let root = sound(&folder, file);
        for tag in ["b", "i", "u"] {
            assert!(root.all(tag).is_empty(), "{file}: <{tag}>");
        }
        assert!(root.all("h1")[0].text.contains(evil), "{file}: {}", root.all("h1")[0].text);
    }
}

/// A page of others is not written over.
#[test]
fn foreign_pages_stay() {
    let folder = folder();
    fs::create_dir(folder.path().join("out")).unwrap();
    let path = folder.path().join("out/report.html");
    fs::write(&path, "<!DOCTYPE html><p>mine</p>").unwrap();
    run(&folder, "identify robot.toml measurements.csv --out out", 1);
    assert_eq!(fs::read_to_string(&path).unwrap(), "<!DOCTYPE html><p>mine</p>");
    run(&folder, "identify robot.toml measurements.csv --out out --force", 0);
    sound(&folder, "out/report.html");
}

#[test]
fn the_view_is_short_and_asks_for_nothing() {
    let script = include_str!("../../src/page/view.js");
    assert!(script.lines().count() < 200);
    for word in ["fetch", "import", "XMLHttpRequest", "eval", "innerHTML", "http"] {
        assert!(!script.contains(word), "{word}");
    }
}

/// The text below an element, whole.
fn words(element: &Element) -> String {
    let children: String = element.children.iter().map(words).collect();
    format!("{}{children}", element.text)
}

/// Points where the nominal tool would be, as if they had been measured.
fn measured(folder: &TempDir, file: &str) {
    let path = folder.path().join(file);
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("nominal_", "")).unwrap();
}

/// What is to be typed, of the section of a page.
fn typed(root: &Element, section: &str) -> String {
    let section = root.id(section).unwrap();
    let line = words(section.all("pre")[0]);
    line.strip_prefix("truearm ").unwrap_or_else(|| panic!("{line}")).to_owned()
}

/// What a plan says to type works as it stands; and it does not promise more than geometry.
#[test]
fn a_plan_says_what_follows() {
    let folder = folder();
    fs::create_dir(folder.path().join("cell")).unwrap();
    fs::rename(folder.path().join("robot.toml"), folder.path().join("cell/arm.toml")).unwrap();
    run(
        &folder,
        "plan cell/arm.toml --poses 20 --candidates 100 --limits LIMITS --out cell/p.csv --html p.html",
        0,
    );
    let root = sound(&folder, "p.html");
    assert!(root.all("p")[0].text.contains("the geometry of the arm"), "{}", root.all("p")[0].text);
    measured(&folder, "cell/p.csv");
    run(&folder, &typed(&root, "next"), 0);
}

/// Explanations that are to be told apart: each by what it says otherwise, with its joints,
/// and what is typed afterwards takes both data sets.
#[test]
fn alternatives_are_told_by_their_difference() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["robot.toml", "measurements.csv"] {
        fs::copy(data("tie").join(name), folder.path().join(name)).unwrap();
    }
    run(&folder, "diagnose robot.toml measurements.csv --out d", 0);
    let root = sound(&folder, "d/report.html");
    let poses = words(root.id("poses").unwrap());
    assert!(poses.contains(" of joint ") && poses.contains(" instead of "), "{poses}");
    let line =
        "plan robot.toml --poses 6 --discriminate measurements.csv --out p.csv --html p.html";
    let said = run(&folder, line, 0);
    let root = sound(&folder, "p.html");
    let rows = root.id("told").unwrap().all("tr");
    assert!(rows.len() > 1);
    for row in &rows[1..] {
        let first = words(row.all("td")[0]);
        assert!(first.contains(" instead of ") && first.contains(" of joint "), "{first}");
        assert!(said.contains(&first), "{first}\n{said}");
    }
    measured(&folder, "p.csv");
    let next = typed(&root, "next");
    assert!(next.contains(" measurements.csv --data p.csv "), "{next}");
    run(&folder, &next, 0);
}

/// Nothing that was not measured is called so.
#[test]
fn what_a_model_predicts_is_said_to_be_predicted() {
    let folder = folder();
    run(&folder, "identify robot.toml measurements.csv --out .", 0);
    for (more, says, not) in [
        ("", "as the model predicts", "before, measured"),
        (" --before off.csv", "before, measured", "as the model predicts"),
    ] {
        run(&folder, &format!("verify model.toml c.csv{more} --out v --force"), 0);
        let root = sound(&folder, "v/report.html");
        let head = words(root.all("header")[0]);
        assert!(head.contains(says) && !head.contains(not), "{head}");
        let verdict = &root.all("p")[0].text;
        assert_eq!(verdict.contains("as the model predicts"), more.is_empty(), "{verdict}");
    }
}

/// A wave of one joint, everything else as drawn, is shown at that joint, not at those that
/// swing the tool alike by a shorter lever.
#[test]
fn curves_without_a_name_are_of_the_joint_that_errs() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(data("ur10-ipa/robot.toml"), folder.path().join("robot.toml")).unwrap();
    let all = fs::read_to_string(data("ur10-ipa/series-c/measurements.csv")).unwrap();
    let joints: Vec<Vec<f64>> = all
        .lines()
        .skip(1)
        .take(500)
        .map(|line| line.split(',').skip(1).take(6).map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let head = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg";
    assert!(all.starts_with(&format!("order,{head},")));
    let row = |q: &Vec<f64>| q.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    for joint in 0..5 {
        let mut text = format!("{head}\n");
        for q in &joints {
            let mut q = q.clone();
            // 0.6 mrad, eight times a turn.
            q[joint] += 0.6e-3_f64.to_degrees() * (8.0 * q[joint].to_radians()).sin();
            text += &(row(&q) + "\n");
        }
        fs::write(folder.path().join("stands.csv"), text).unwrap();
        run(&folder, "fk robot.toml stands.csv --out real.csv --force", 0);
        let real = fs::read_to_string(folder.path().join("real.csv")).unwrap();
        let mut text = format!("{head},x_mm,y_mm,z_mm\n");
        for (i, (q, line)) in joints.iter().zip(real.lines().skip(1)).enumerate() {
            let point = line.split(',').skip(6).take(3).map(|cell| cell.parse::<f64>().unwrap());
            // Noise of 0.02 mm, of the same kind everywhere.
            let noisy = point.enumerate().map(|(c, x)| {
                let noise = (0.618_034 * (3 * i + c) as f64 * 7.0).fract() - 0.5;
                (x + 0.07 * noise).to_string()
            });
            text += &format!("{},{}\n", row(q), noisy.collect::<Vec<_>>().join(","));
        }
        fs::write(folder.path().join("measurements.csv"), text).unwrap();
        run(&folder, "identify robot.toml measurements.csv --out out --force", 0);
        let left = sound(&folder, "out/report.html");
        let left = left.id("left").unwrap_or_else(|| panic!("joint {}: no curve", joint + 1));
        let titles: Vec<&str> = left.all("h3").iter().map(|h| h.text.as_str()).collect();
        let own = format!("Joint {0}, left over, against the reading of joint {0}", joint + 1);
        assert_eq!(titles[0], own, "{titles:?}");
        let explains: Vec<f64> = left
            .all("figcaption")
            .iter()
            .map(|caption| {
                let (_, rest) = caption.text.split_once("explains ").unwrap();
                rest.split(' ').next().unwrap().parse().unwrap()
            })
            .collect();
        println!("joint {}: {titles:?} {explains:?}", joint + 1);
        // Of what bins and the lever leave of it, not again the whole.
        assert!(explains[1..].iter().all(|mm| *mm < 0.4 * explains[0]), "{titles:?} {explains:?}");
    }
}

/// Methods that do alike share the first place, those that did not come to rest are named, and
/// lines on each other say so.
#[test]
fn methods_that_do_alike_are_not_ranked() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(data("ur10-ipa/robot.toml"), folder.path().join("robot.toml")).unwrap();
    let all = fs::read_to_string(data("ur10-ipa/series-c/measurements.csv")).unwrap();
    let rows: String = all.lines().take(301).map(|line| format!("{line}\n")).collect();
    fs::write(folder.path().join("measurements.csv"), rows).unwrap();
    let said = run(&folder, "compare robot.toml measurements.csv --out c", 0);
    let root = sound(&folder, "c/report.html");
    let rest = said.lines().find_map(|l| l.strip_prefix("did not come to rest: "));
    let page = words(&root);
    assert_eq!(rest.is_some(), page.contains("Did not come to rest"), "{said}");
    if let Some(rest) = rest {
        assert!(page.contains(&format!("Did not come to rest: {rest}.")), "{said}");
    }
    let alike = said.lines().find(|l| l.starts_with("cannot be told apart"));
    let verdict = &root.all("p")[0].text;
    assert_eq!(alike.is_some(), verdict.contains("cannot be told apart"), "{verdict}\n{said}");
    assert!(rest.is_some() && alike.is_some(), "{said}");
    println!("{verdict}\n{said}");
    let svg = fs::read_to_string(folder.path().join("c/errors.svg")).unwrap();
    assert!(svg.contains(" (on "), "no method lies on another");
}
