//! Inputs that are wrong, a line each: what is changed in a sound file, and what
//! the message must say. Nothing is accepted in silence, and nothing panics.

use std::path::Path;

use truearm_host::model::{Commanded, Measurements, Model, Robot};

const SHIPPED: &str = include_str!("../../../tests/data/seed-table-8/robot.toml");
const ROWS: &str = include_str!("../../../tests/data/seed-table-8/measurements.csv");

/// The shipped arm with everything that a robot.toml may have.
fn robot_text() -> String {
    let joints = SHIPPED
        .replace("beta_deg = 0.0", "beta_deg = 0.0\nlimits_deg = [-360, 360]\ngear_ratio = 101");
    let links = "\n[[links]]\nmass_kg = 3.5\ncom_mm = [10.0, 0.0, 20.0]\n".repeat(6);
    let head = joints.replacen(
        "[[joints]]",
        "serial = \"7\"\nreference_temperature_c = 21.5\n\n[[joints]]",
        1,
    );
    let base = "\n[base]\nxyz_mm = [1.0, 2.0, 3.0]\nrpy_deg = [0.5, 0.0, 0.0]\n";
    format!("{head}{base}{links}\n[payload]\ncom_mm = [0.0, 0.0, 50.0]\n")
}

fn robot() -> Robot {
    Robot::parse(Path::new("robot.toml"), SHIPPED).unwrap()
}

/// Message and help, or what it says instead of refusing.
fn said<T>(result: truearm_host::Result<T>) -> String {
    match result {
        Ok(_) => "accepted".to_owned(),
        Err(e) => format!("{e} -> {}", e.help()).split_whitespace().collect::<Vec<_>>().join(" "),
    }
}

fn expect(what: &str, message: &str, says: &[&str]) {
    for part in says {
        assert!(message.contains(part), "{what}\ngives {message}\nshould say {part}");
    }
}

/// In robot.toml: what stands there, what stands there instead, the message.
const ROBOTS: [(&str, &str, &[&str]); 67] = [
    ("gear_ratio = 101", "gear_ratio = 0", &["robot.toml:", "gear_ratio = 0 ->", "such as 101"]),
    ("gear_ratio = 101", "gear_ratio = -101", &["gear_ratio = -101", "its sense does not matter"]),
    ("gear_ratio = 101", "gear_ratio = nan", &["gear_ratio = NaN"]),
    ("gear_ratio = 101", "gear_ratio = inf", &["gear_ratio = inf"]),
    ("gear_ratio = 101", "gear_ratio = 1e9", &["gear_ratio = 1000000000"]),
    ("gear_ratio = 101", "gear_ratio = \"1:101\"", &["invalid type: string", "expected"]),
    ("mass_kg = 3.5", "mass_kg = 0", &["mass_kg = 0 ->", "leave [[links]] out"]),
    ("mass_kg = 3.5", "mass_kg = -3.5", &["mass_kg = -3.5", "in kg"]),
    ("mass_kg = 3.5", "mass_kg = nan", &["mass_kg = NaN"]),
    ("mass_kg = 3.5", "mass_kg = inf", &["mass_kg = inf"]),
    ("mass_kg = 3.5", "mass_kg = 35000", &["mass_kg = 35000"]),
    ("mass_kg = 3.5", "mass_g = 3500", &["missing field `mass_kg`", "is `mass_kg` meant?"]),
    ("com_mm = [10.0, 0.0, 20.0]", "com_mm = [nan, 0.0, 20.0]", &["com_mm is NaN"]),
    ("com_mm = [10.0, 0.0, 20.0]", "com_mm = [10.0, inf, 20.0]", &["com_mm is inf"]),
    ("com_mm = [10.0, 0.0, 20.0]", "com_mm = [10.0, 0.0]", &["2 numbers where 3"]),
    (
        "com_mm = [10.0, 0.0, 20.0]",
        "com_mm = [10.0, 0.0, 20000.0]",
        &["com_mm has 20000", "up to 10 m"],
    ),
    ("com_mm = [0.0, 0.0, 50.0]", "com_mm = [0.0, nan, 50.0]", &["payload.com_mm is NaN"]),
    ("com_mm = [0.0, 0.0, 50.0]", "com_mm = [0.0, 0.0, 1e7]", &["payload.com_mm has 10000000"]),
    ("[0.0, 0.0, -9.81]", "[0.0, 0.0, nan]", &["gravity_m_s2 is NaN"]),
    ("[0.0, 0.0, -9.81]", "[0.0, 0.0, 0.0]", &["gravity_m_s2 of 0.000", "leave it out"]),
    ("[0.0, 0.0, -9.81]", "[0.0, 0.0, -9810.0]", &["gravity_m_s2 of 9810.000", "9.81"]),
    ("[0.0, 0.0, -9.81]", "[0.0, 0.0, -1.0]", &["gravity_m_s2 of 1.000"]),
    ("[0.0, 0.0, -9.81]", "[9.81, 0.0, -9.81]", &["gravity_m_s2 of 13.873"]),
    ("[0.0, 0.0, -9.81]", "-9.81", &["invalid type: floating point", "sequence"]),
    (
        "reference_temperature_c = 21.5",
        "reference_temperature_c = 294.65",
        &["= 294.65", "294.65 K are 21.50"],
    ),
    ("reference_temperature_c = 21.5", "reference_temperature_c = nan", &["= NaN", "such as 20"]),
    ("reference_temperature_c = 21.5", "reference_temperature_c = -300", &["= -300"]),
    (
        "limits_deg = [-360, 360]",
        "limits_deg = [360, -360]",
        &["limits [360, -360]", "lower limit first"],
    ),
    ("limits_deg = [-360, 360]", "limits_deg = [nan, 360]", &["limits is NaN"]),
    ("limits_deg = [-360, 360]", "limits_mm = [-360, 360]", &["limits in the wrong unit"]),
    ("limits_deg = [-360, 360]", "limits_deg = [-360]", &["1 number where 2 are expected"]),
    ("limits_deg = [-360, 360]", "limits_deg = [-3,14, 3,14]", &["4 numbers", "not a comma"]),
    ("[0.0, 0.0, -9.81]", "[0.0, 0.0, -9.81, 3.0]", &["4 numbers where 3 are expected"]),
    ("com_mm = [0.0, 0.0, 50.0]", "com_mm = [0,5, 0, 50]", &["4 numbers where 3 are expected"]),
    ("sigma_mm = 0.03", "sigma_mm = 0", &["measurement_sigma_mm = 0"]),
    ("sigma_mm = 0.03", "sigma_mm = -0.03", &["measurement_sigma_mm = -0.03", "such as 0.03"]),
    ("sigma_mm = 0.03", "sigma_mm = nan", &["measurement_sigma_mm = NaN"]),
    ("sigma_mm = 0.03", "sigma_mm = 30", &["measurement_sigma_mm = 30"]),
    ("a_mm = 425.0", "a_mm = 42500.0", &["a_mm = 42500", "up to 10 m"]),
    ("a_mm = 425.0", "a_mm = nan", &["a_mm is NaN"]),
    ("a_mm = 425.0", "a_mm = inf", &["a_mm is inf"]),
    ("a_mm = 425.0", "a_mm = \"425\"", &["invalid type: string"]),
    ("a_mm = 425.0", "a_mm = 425,0", &["robot.toml:"]),
    ("a_mm = 425.0", "a_m = 0.425", &["missing field `a_mm`", "unknown key", "is `a_mm` meant?"]),
    ("a_mm = 425.0", "a_mm = 425.0\na_mm = 425.0", &["duplicate key"]),
    ("a_mm = 425.0", "a_mm = 425.0\nkind = \"helical\"", &["kind = \"helical\"", "\"prismatic\""]),
    ("a_mm = 425.0", "a_mm = 425.0\nkind = \"Revolute\"", &["kind = \"Revolute\""]),
    ("a_mm = 425.0", "a_mm = 425.0\nkind = \"prismatic\"", &["d_mm on a prismatic joint"]),
    ("a_mm = 425.0", "a_mm = 425.0\nd_offset_mm = 3", &["d_offset_mm on a revolute joint"]),
    ("d_mm = 100.0\n", "", &["joint without d_mm", "add d_mm"]),
    ("d_mm = 100.0", "d_mm = -20000.0", &["d_mm = -20000"]),
    ("alpha_deg = 90.0", "alpha_deg = 900.0", &["alpha_deg = 900", "up to 360"]),
    ("alpha_deg = 90.0", "alpha_deg = nan", &["alpha_deg is NaN"]),
    ("alpha_deg = 90.0", "alpha = 90.0", &["missing field `alpha_deg`", "is `alpha_deg` meant?"]),
    ("alpha_deg = 90.0", "alfa_deg = 90.0", &["is `alpha_deg` meant?"]),
    (
        "theta_offset_deg = 0.0",
        "theta_deg = 0.0",
        &["missing field `theta_offset_deg`", "is `theta_offset_deg` meant?"],
    ),
    ("theta_offset_deg = 0.0", "theta_offset_deg = -4000", &["theta_offset_deg = -4000"]),
    ("beta_deg = 0.0", "beta_deg = inf", &["beta_deg is inf"]),
    ("xyz_mm = [1.0, 2.0, 3.0]", "xyz_mm = [1.0, nan, 3.0]", &["base.xyz_mm is NaN"]),
    ("xyz_mm = [1.0, 2.0, 3.0]", "xyz_mm = [1.0, 2e6, 3.0]", &["base.xyz_mm has 2000000"]),
    ("rpy_deg = [0.5, 0.0, 0.0]", "rpy_deg = [0.5, inf, 0.0]", &["base.rpy_deg is inf"]),
    ("rpy_deg = [0.5, 0.0, 0.0]", "rpy_deg = [5000.0, 0.0, 0.0]", &["base.rpy_deg = 5000"]),
    ("xyz_mm = [0.0, 0.0, 0.0]", "xyz_mm = [0.0, 0.0, nan]", &["tool.xyz_mm is NaN"]),
    ("name = \"6R", "name = 6 #\"6R", &["invalid type: integer `6`"]),
    ("[[joints]]", "[[joints]", &["robot.toml:"]),
    ("[[joints]]", "[[joints]]\n[[joints]]", &["missing field `alpha_deg`"]),
    ("[tool]", "[tool", &["robot.toml:"]),
];

#[test]
fn robots() {
    let text = robot_text();
    assert_eq!(said(Robot::parse(Path::new("robot.toml"), &text)), "accepted");
    for (from, to, says) in ROBOTS {
        assert!(text.contains(from), "{from}");
        let broken = text.replacen(from, to, 1);
        let message = said(Robot::parse(Path::new("robot.toml"), &broken));
        expect(to, &message, says);
    }
}

/// Whole files in the place of a robot.toml.
#[test]
fn no_robots() {
    let radians =
        SHIPPED.replace("beta_deg = 0.0", "beta_deg = 0.0\nlimits_deg = [-2.9671, 2.9671]");
    let many = SHIPPED.to_owned()
        + &SHIPPED[SHIPPED.find("[[joints]]").unwrap()..SHIPPED.find("[tool]").unwrap()].repeat(9);
    let cases: [(&str, &[&str]); 8] = [
        ("", &["no [[joints]]", "alpha_deg, a_mm"]),
        ("name = \"x\"", &["no [[joints]]"]),
        (ROWS, &["a table, not a TOML file", "are the arguments swapped?"]),
        ("a;b;c\n1;2;3\n", &["a table, not a TOML file"]),
        ("a\tb\tc\n1\t2\t3\n", &["a table, not a TOML file"]),
        ("<robot name=\"arm\">", &["robot.toml:1"]),
        (&radians, &["limits_deg = [-2.9671, 2.9671]", "radians", "give degrees: [-170.0, 170.0]"]),
        (&many, &["60 joints", "truearm handles up to"]),
    ];
    for (text, says) in cases {
        let head: String = text.chars().take(60).collect();
        expect(&head, &said(Robot::parse(Path::new("robot.toml"), text)), says);
    }
    // One joint that hardly moves is no mistake, nor is what a converter rounded.
    let sound = SHIPPED
        .replacen("beta_deg = 0.0", "beta_deg = 0.0\nlimits_deg = [-5, 5]", 1)
        .replacen("alpha_deg = 0.0", "alpha_deg = 0.000000042595", 1);
    let robot = Robot::parse(Path::new("robot.toml"), &sound).unwrap();
    assert!(robot.warnings.is_empty(), "{:?}", robot.warnings);
    // What can be left out and is misspelt is shown beside what it resembles.
    for (wrong, key) in
        [("gear_ration", "gear_ratio"), ("limit_deg", "limits_deg"), ("beta", "beta_deg")]
    {
        let text = SHIPPED.replacen("beta_deg = 0.0", &format!("{wrong} = 1"), 1);
        let robot = Robot::parse(Path::new("robot.toml"), &text).unwrap();
        let told = format!("unknown key `joints.0.{wrong}` ignored; is `{key}` meant?");
        assert!(robot.warnings.iter().any(|w| w.ends_with(&told)), "{:?}", robot.warnings);
    }
}

/// The shipped rows with all columns that they may have.
fn rows_text() -> String {
    let mut lines = ROWS.lines();
    let more = "station,marker,series,sigma_mm,temperature_c,payload_kg,dir1,qx,qy,qz,qw,time_s,order,kind";
    let mut text = format!("{},{more}\n", lines.next().unwrap());
    for (i, line) in lines.enumerate() {
        text += &format!("{line},A,ball,1,0.02,21.5,0.5,1,0,0,0,1,{i},{i},point\n");
    }
    text
}

/// In the fourth line of measurements.csv: the column, the cell, the message.
const CELLS: [(&str, &str, &[&str]); 41] = [
    ("q1_deg", "", &["m.csv:4, column q1_deg: empty cell"]),
    ("q1_deg", "nan", &["m.csv:4, column q1_deg: nan is not a finite number"]),
    ("q1_deg", "inf", &["inf is not a finite number", "measure it again"]),
    ("q1_deg", "1.2.3", &["\"1.2.3\" is not a number"]),
    ("q1_deg", "1 2", &["\"1 2\" is not a number"]),
    ("q1_deg", "30°", &["\"30°\" is not a number"]),
    ("q1_deg", "\"12,5\"", &["\"12,5\" is not a number", "decimal point"]),
    ("q6_deg", "1e6", &["1000000 degrees", "in degrees"]),
    ("q6_deg", "#REF!", &["\"#REF!\" is not a number"]),
    ("x_mm", "", &["column x_mm: empty cell", "delete the row"]),
    ("x_mm", "NaN", &["NaN is not a finite number"]),
    ("x_mm", "-inf", &["-inf is not a finite number"]),
    ("x_mm", "2000000", &["2000 m away", "in mm"]),
    ("y_mm", "n/a", &["\"n/a\" is not a number"]),
    ("z_mm", "1,234.5", &["m.csv:4: 24 cells where the header has 23"]),
    ("z_mm", "--3", &["\"--3\" is not a number"]),
    ("station", "a", &["station \"A\" and \"a\" differ in case only", "alike"]),
    ("marker", "Ball", &["marker \"ball\" and \"Ball\" differ in case only"]),
    ("sigma_mm", "0", &["sigma 0", "positive"]),
    ("sigma_mm", "-0.02", &["sigma -0.02"]),
    ("sigma_mm", "20", &["sigma 20", "such as 0.03"]),
    ("sigma_mm", "nan", &["column sigma_mm: nan is not a finite number"]),
    ("temperature_c", "294.65", &["294.65 degrees Celsius", "these look like kelvin"]),
    ("temperature_c", "-200", &["-200 degrees Celsius"]),
    ("temperature_c", "1e3", &["1000 degrees Celsius"]),
    ("temperature_c", "nan", &["column temperature_c: nan is not a finite number"]),
    ("temperature_c", "warm", &["\"warm\" is not a number"]),
    ("payload_kg", "-1", &["payload of -1 kg", "0 or more"]),
    ("payload_kg", "50000", &["payload of 50000 kg", "in kg"]),
    ("payload_kg", "inf", &["column payload_kg: inf is not a finite number"]),
    ("dir1", "2", &["direction 2", "+1 came to rest"]),
    ("dir1", "0.5", &["direction 0.5"]),
    ("dir1", "+", &["\"+\" is not a number"]),
    ("qw", "0.5", &["quaternion of length 0.500", "unit quaternion"]),
    ("qx", "1", &["quaternion of length 1.414"]),
    ("qz", "nan", &["column qz: nan is not a finite number"]),
    ("time_s", "12:03:55", &["column time_s: \"12:03:55\" is not a number"]),
    ("time_s", "inf", &["column time_s: inf"]),
    ("order", "third", &["\"third\" is not a number"]),
    ("kind", "pt", &["kind \"pt\"", "point"]),
    ("kind", "Point", &["kind \"Point\""]),
];

fn with_cell(text: &str, column: &str, value: &str) -> String {
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let at = names.iter().position(|name| *name == column).unwrap();
    let line = |(i, line): (usize, &str)| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if i == 3 {
            cells[at] = value;
        }
        cells.join(",") + "\n"
    };
    text.lines().enumerate().map(line).collect()
}

#[test]
fn cells() {
    let text = rows_text();
    let read = |text: &str| said(Measurements::parse(Path::new("m.csv"), text, &robot()));
    assert_eq!(read(&text), "accepted");
    for (column, value, says) in CELLS {
        expect(&format!("{column} {value}"), &read(&with_cell(&text, column, value)), says);
    }
}

/// Tables that are wrong as a whole.
#[test]
fn tables() {
    let renamed = |from: &str, to: &str| ROWS.replacen(from, to, 1);
    let header = ROWS.lines().next().unwrap();
    let under = |units: &str| ROWS.replacen('\n', &format!("\n{units}\n"), 1);
    let mm = "deg,deg,deg,deg,deg,deg,mm,mm,mm";
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("empty", String::new(), &["the file is empty", "header line"]),
        ("blank", "\n\n".to_owned(), &["the file is empty"]),
        ("header", format!("{header}\n"), &["no data rows", "add rows below the headings"]),
        ("twice", renamed("q2_deg", "q1_deg"), &["column q1_deg stands there twice"]),
        ("semicolons", ROWS.replace(',', ";"), &["cells are separated by `;`", "truearm import"]),
        ("tabs", ROWS.replace(',', "\t"), &["missing column q1_deg", "truearm import"]),
        (
            "q1",
            renamed("q1_deg", "q1"),
            &[
                "missing column q1_deg",
                "found \"q1\", \"q2_deg\"",
                "q1_deg may be \"q1\"",
                "truearm import m.csv",
            ],
        ),
        ("J1", renamed("q1_deg", "J1 [rad]"), &["q1_deg may be \"J1 [rad]\"", "revolute"]),
        ("case", renamed("q1_deg", "Q1_deg"), &["q1_deg may be \"Q1_deg\""]),
        ("q1_rad", renamed("q1_deg", "q1_rad"), &["q1_deg may be \"q1_rad\""]),
        (
            "q1_mm",
            renamed("q1_deg", "q1_mm"),
            &["missing column q1_deg", "q1_deg may be \"q1_mm\""],
        ),
        (
            "X",
            renamed("x_mm", "X"),
            &["missing column x_mm", "x_mm may be \"X\"", "needs x_mm, y_mm, z_mm"],
        ),
        ("x_m", renamed("x_mm", "x_m"), &["x_mm may be \"x_m\""]),
        (
            "posz",
            renamed("z_mm", "Pos Z (mm)"),
            &["missing column z_mm", "z_mm may be \"Pos Z (mm)\""],
        ),
        (
            "q7",
            ROWS.replace('\n', ",0\n").replacen("z_mm,0", "z_mm,q7_deg", 1),
            &["column q7_deg, but robot.toml has 6 joints"],
        ),
        (
            "qx",
            ROWS.replace('\n', ",0\n").replacen("z_mm,0", "z_mm,qx", 1),
            &["orientation needs all of qx, qy, qz, qw"],
        ),
        ("short", ROWS.replacen(",209.626", "", 1), &["m.csv:2: 8 cells where the header has 9"]),
        ("toml", SHIPPED.to_owned(), &["a TOML file, not a table", "are the arguments swapped?"]),
        (
            "rad",
            under(&mm.replace("deg", "rad")),
            &["m.csv:2, column q1_deg: unit \"rad\" under the heading q1_deg", "truearm import"],
        ),
        (
            "metres",
            under(&mm.replace("mm", "[m]")),
            &["column x_mm: unit \"[m]\" under the heading x_mm"],
        ),
        (
            "numbers",
            ROWS.lines().skip(1).map(|l| format!("{l}\n")).collect(),
            &["no header: the first line is numbers", "truearm import m.csv"],
        ),
        ("words", "once upon a time\nthere was an arm\n".to_owned(), &["missing column q1_deg"]),
        ("json", "{\"q1\": 3}\n".to_owned(), &["missing column q1_deg"]),
    ];
    for (name, text, says) in cases {
        expect(name, &said(Measurements::parse(Path::new("m.csv"), &text, &robot())), says);
    }
    // A row of the right units is understood.
    let data = Measurements::parse(Path::new("m.csv"), &under(mm), &robot()).unwrap();
    assert_eq!(data.rows.len(), 18);
    // Bytes that are no text.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("book.xlsx");
    std::fs::write(&path, b"PK\x03\x04\xff\xfe").unwrap();
    expect(
        "xlsx",
        &said(Measurements::read(&path, &robot())),
        &["not UTF-8", "truearm import", ".xlsx"],
    );
    expect("none", &said(Measurements::read(Path::new("nowhere.csv"), &robot())), &["nowhere.csv"]);
}

/// What a verification reads.
#[test]
fn commanded() {
    let joints = (1..=6)
        .fold(ROWS.to_owned(), |t, j| t.replace(&format!("q{j}_deg"), &format!("cmd{j}_deg")));
    let points: String = ROWS
        .lines()
        .enumerate()
        .map(|(i, line)| {
            let xyz = line.splitn(7, ',').nth(6).unwrap();
            let head = if i == 0 { "cmd_x_mm,cmd_y_mm,cmd_z_mm" } else { xyz };
            format!("{head},{xyz}\n")
        })
        .collect();
    let read = |text: &str| said(Commanded::parse(Path::new("c.csv"), text, &robot()));
    assert_eq!((read(&joints), read(&points)), ("accepted".to_owned(), "accepted".to_owned()));
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("empty", String::new(), &["the file is empty"]),
        ("neither", ROWS.to_owned(), &["no commanded joints and no commanded points", "cmd1_deg"]),
        (
            "both",
            joints.replacen("x_mm,y_mm", "cmd_x_mm,y_mm", 1),
            &["both commanded joints and commanded points"],
        ),
        ("cmd4", joints.replacen("cmd4_deg", "q4_deg", 1), &["missing column cmd4_deg"]),
        ("cmd_z", points.replacen("cmd_z_mm", "z_cmd", 1), &["missing column cmd_z_mm"]),
        (
            "word",
            points.replacen("\n209.973", "\nfar", 1),
            &["c.csv:2, column cmd_x_mm: \"far\" is not a coordinate"],
        ),
        (
            "far",
            points.replacen("\n209.973", "\n1e9", 1),
            &["\"1e9\" is not a coordinate", "robot's frame"],
        ),
        ("nan", points.replacen("\n209.973", "\nnan", 1), &["\"nan\" is not a coordinate"]),
        ("x", points.replacen(",x_mm", ",measured", 1), &["missing column x_mm"]),
    ];
    for (name, text, says) in cases {
        expect(name, &read(&text), says);
    }
}

/// A robot.toml is no model, and a table is neither.
#[test]
fn models() {
    let folder = tempfile::tempdir().unwrap();
    let read = |text: &str| {
        let path = folder.path().join("model.toml");
        std::fs::write(&path, text).unwrap();
        said(Model::read(&path))
    };
    expect("robot", &read(SHIPPED), &["no identified model", "as written by `truearm identify`"]);
    expect("table", &read(ROWS), &["a table, not a TOML file"]);
    expect("empty", &read(""), &["no [[joints]]"]);
    let gravity = SHIPPED.replace("-9.81", "nan");
    expect("gravity", &read(&gravity), &["gravity_m_s2 is NaN"]);
}
