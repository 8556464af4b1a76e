//! Tables as authors publish them become one measurements.csv, a second run by
//! import.toml gives the same bytes, and what cannot be told names its flag.

use std::fs;
use std::path::{Path, PathBuf};

use crate::published::{ROBOT, latin1, ods, plain, rows, scaled, text, utf16, xlsx};
use tempfile::TempDir;
use truearm_host::headings::Unit;
use truearm_host::import::{ImportOptions, Imported, JoinAsked, import};
use truearm_host::model::{Measurements, Robot};

/// Files of a case: name and bytes.
pub type Files = Vec<(&'static str, Vec<u8>)>;

pub fn written(files: &Files) -> (TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let path = |(name, bytes): &(&str, Vec<u8>)| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let paths = files.iter().map(path).collect();
    (folder, paths)
}

pub fn robot() -> Robot {
    Robot::parse(Path::new("robot.toml"), ROBOT).unwrap()
}

pub fn imported(files: &Files, robot: Option<&Robot>, options: &ImportOptions) -> Imported {
    let (_folder, paths) = written(files);
    import(&paths, robot, None, options).unwrap_or_else(|e| panic!("{e} -> {}", e.help()))
}

/// Message and help of what is refused.
pub fn refused(files: &Files, robot: Option<&Robot>, options: &ImportOptions) -> String {
    let (_folder, paths) = written(files);
    let error = import(&paths, robot, None, options).unwrap_err();
    format!("{error} -> {}", error.help()).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The paper's points in the shapes of those who publish such.
pub fn shapes() -> Vec<(&'static str, Vec<u8>)> {
    let semicolons =
        |decimal| text("J1;J2;J3;J4;J5;J6;X;Y;Z\n", &scaled(true, false), ";", decimal);
    let names = "A1 [°],A2 [°],A3 [°],A4 [°],A5 [°],A6 [°],X,Y,Z\n";
    let units = "# calibration of an arm\n# by nobody\nq1\tq2\tq3\tq4\tq5\tq6\tpx\tpy\tpz\n\
                 rad\trad\trad\trad\trad\trad\tm\tm\tm\n";
    let book = [
        "theta1 (rad)",
        "theta2 (rad)",
        "theta3 (rad)",
        "theta4 (rad)",
        "theta5 (rad)",
        "theta6 (rad)",
        "Measured X",
        "Measured Y",
        "Measured Z",
    ];
    let numbered: Vec<Vec<f64>> = rows()
        .into_iter()
        .enumerate()
        .map(|(i, row)| [vec![i as f64 + 1.0], row].concat())
        .collect();
    let ur = "shoulder_pan_joint,shoulder_lift_joint,elbow_joint,wrist_1_joint,wrist_2_joint,\
              wrist_3_joint,x,y,z\n";
    let fixed: String = scaled(false, true)
        .iter()
        .map(|row| {
            let cells: Vec<String> = row.iter().map(|v| format!("{v:>14.8}")).collect();
            cells.join("") + "\n"
        })
        .collect();
    let padded: String = plain().lines().map(|l| l.replace(',', ";") + ";;\n").collect();
    let quoted: String = plain()
        .lines()
        .map(|l| format!("\"{}\"\n", l.replace(',', "\",\"").replace('.', ",")))
        .collect();
    vec![
        ("plain.csv", plain().into()),
        ("radians and decimal commas.csv", semicolons(",").into()),
        (
            "utf-8 with a mark.csv",
            [b"\xef\xbb\xbf".as_slice(), semicolons(",").as_bytes()].concat(),
        ),
        ("latin-1.csv", latin1(&text(names, &rows(), ",", "."))),
        ("utf-16 little.txt", utf16(&semicolons("."), true)),
        ("utf-16 big.txt", utf16(&text(units, &scaled(true, true), "\t", "."), false)),
        ("utf-16 unmarked.txt", utf16(&semicolons(","), true)[2..].to_vec()),
        ("row of units.tsv", text(units, &scaled(true, true), "\t", ".").into()),
        ("no headings.csv", text("", &rows(), ",", ".").into()),
        ("no headings, radians.txt", text("", &scaled(true, false), " ", ".").into()),
        ("counted rows.csv", text("", &numbered, ";", ",").into()),
        ("fixed columns.dat", fixed.into()),
        ("windows.csv", semicolons(",").replace('\n', "\r\n").into()),
        ("ros.csv", text(ur, &scaled(true, true), ",", ".").into()),
        ("padded.csv", padded.into()),
        ("quoted decimal commas.csv", quoted.into()),
        ("book.xlsx", xlsx("Vermessung 12.3.", &book, &scaled(true, false))),
        (
            "sheet.ods",
            ods(&plain().lines().next().unwrap().split(',').collect::<Vec<_>>(), &rows()),
        ),
        (
            "from zero.csv",
            text(
                "actual_q_0,actual_q_1,actual_q_2,actual_q_3,actual_q_4,actual_q_5,\
            x_m,y_m,z_m\n",
                &scaled(true, true),
                ",",
                ".",
            )
            .into(),
        ),
    ]
}

/// Each gives the plain table, first by guess and then by what it wrote down.
#[test]
fn one_table_in_many_shapes() {
    let arm = robot();
    for (name, bytes) in shapes() {
        for robot in [None, Some(&arm)] {
            let (folder, paths) = written(&vec![(name, bytes.clone())]);
            let options = ImportOptions::default();
            let found = import(&paths, robot, None, &options)
                .unwrap_or_else(|e| panic!("{name}: {e} -> {}", e.help()));
            assert_eq!(found.csv, plain(), "{name}: {}", found.config);
            assert_eq!((found.rows, found.poses), (18, 18), "{name}");
            assert!(found.columns.iter().all(|c| !c.because.is_empty()), "{name}");
            let path = folder.path().join("import.toml");
            let again = import(&paths, robot, Some((&path, &found.config)), &options)
                .unwrap_or_else(|e| panic!("{name}: {e} -> {}\n{}", e.help(), found.config));
            assert_eq!(again.csv, plain(), "{name}: {}", found.config);
        }
    }
}

/// A measurements.csv is a table like any other: 1,495 rows of a UR10, with the
/// points it was sent to beside those that were measured.
#[test]
fn our_own_tables() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/ur10-ipa");
    let arm = Robot::read(&folder.join("robot.toml")).unwrap();
    let path = folder.join("series-b/measurements.csv");
    let found =
        import(std::slice::from_ref(&path), Some(&arm), None, &ImportOptions::default()).unwrap();
    let (ours, plain) = (
        Measurements::parse(Path::new("m.csv"), &found.csv, &arm).unwrap(),
        Measurements::read(&path, &arm).unwrap(),
    );
    assert_eq!(ours.poses, plain.poses);
    for (row, expected) in ours.rows.iter().zip(&plain.rows) {
        assert_eq!(
            (&row.q, row.measured, row.station),
            (&expected.q, expected.measured, expected.station)
        );
        assert_eq!((row.temperature, row.order), (expected.temperature, expected.order));
    }
    assert_eq!(found.left_out, ["goal_x_mm", "goal_y_mm", "goal_z_mm"]);
}

/// A tracker's export in the shape of Leica's and SpatialAnalyzer's, and the
/// joints of the controller: other order, other labels.
fn controller_and_tracker() -> Files {
    let mut joints = String::from("Pose,A1,A2,A3,A4,A5,A6\n");
    let mut points =
        String::from("// Messung Größe 3\nPunkt;X [mm];Y [mm];Z [mm];Temperatur [°C];Zeit\n");
    for (i, row) in rows().iter().enumerate() {
        let cells: Vec<String> = row[..6].iter().map(f64::to_string).collect();
        joints += &format!("{},{}\n", i + 1, cells.join(","));
    }
    for (i, row) in rows().iter().enumerate().rev() {
        let cells: Vec<String> = row[6..].iter().map(|v| v.to_string().replace('.', ",")).collect();
        points += &format!("A::P{:03};{};21,5;12:0{}:30\n", i + 1, cells.join(";"), i % 10);
    }
    vec![("joints.csv", joints.into()), ("tracker.txt", latin1(&points))]
}

#[test]
fn two_files_on_a_key() {
    let options = ImportOptions::default();
    let files = controller_and_tracker();
    let found = imported(&files, None, &options);
    let arm = robot();
    let data = Measurements::parse(Path::new("m.csv"), &found.csv, &arm).unwrap();
    let plain = Measurements::parse(Path::new("m.csv"), &plain(), &arm).unwrap();
    assert_eq!(data.rows.len(), 18);
    // In the order of the joints' file: so the arm moved.
    for (row, expected) in data.rows.iter().zip(&plain.rows) {
        assert_eq!((&row.q, row.measured), (&expected.q, expected.measured));
        assert_eq!(row.temperature, Some(21.5));
    }
    assert_eq!(data.rows[17].time, Some(7.0 * 60.0), "of 12:07:30, the first at 12:00:30");
    assert!(found.join.unwrap().contains("same labels"));
    let (_folder, paths) = written(&files);
    let again = import(&paths, None, Some((Path::new("import.toml"), &found.config)), &options);
    assert_eq!(again.unwrap().csv, found.csv);
    // A tracker that missed a point.
    let mut short = files;
    let text: String = String::from_utf8(short[0].1.clone()).unwrap();
    short[0].1 = text
        .lines()
        .filter(|l| !l.starts_with("7,"))
        .map(|l| format!("{l}\n"))
        .collect::<String>()
        .into();
    let found = imported(&short, None, &options);
    assert_eq!(found.rows, 17);
    assert!(
        found.warnings.iter().any(|w| w.contains("without a partner") && w.contains("A::P007")),
        "{:?}",
        found.warnings
    );
}

#[test]
fn two_files_by_order_and_stacked() {
    let part = |columns: std::ops::Range<usize>, header: &str| {
        let rows: Vec<Vec<f64>> = rows().iter().map(|row| row[columns.clone()].to_vec()).collect();
        text(header, &rows, ",", ".").into_bytes()
    };
    for headers in [["q1,q2,q3,q4,q5,q6\n", "x,y,z\n"], ["", ""]] {
        let files = vec![("q.csv", part(0..6, headers[0])), ("p.csv", part(6..9, headers[1]))];
        let found = imported(&files, None, &ImportOptions::default());
        assert_eq!(found.csv, plain());
    }
    // Of different lengths nobody knows which row is whose.
    let shorter =
        text("x,y,z\n", &rows()[1..].iter().map(|r| r[6..].to_vec()).collect::<Vec<_>>(), ",", ".");
    let files = vec![("q.csv", part(0..6, "q1,q2,q3,q4,q5,q6\n")), ("p.csv", shorter.into())];
    let message = refused(&files, None, &ImportOptions::default());
    assert!(
        message.contains("files of different lengths") && message.contains("--join COLUMN"),
        "{message}"
    );
    // Two sessions with everything in each.
    let plain = plain();
    let lines: Vec<&str> = plain.lines().collect();
    let session = |rows: &[&str]| format!("{}\n{}\n", lines[0], rows.join("\n")).into_bytes();
    let files =
        vec![("monday.csv", session(&lines[1..10])), ("tuesday.csv", session(&lines[10..]))];
    let found = imported(&files, None, &ImportOptions::default());
    let data = Measurements::parse(Path::new("m.csv"), &found.csv, &robot()).unwrap();
    let series: Vec<&str> = data.rows.iter().filter_map(|r| r.series.as_deref()).collect();
    assert_eq!(series, [["monday"; 9], ["tuesday"; 9]].concat());
    let without: String =
        found.csv.lines().map(|l| l.rsplit_once(',').unwrap().0.to_owned() + "\n").collect();
    assert_eq!(without, plain);
}

/// Orientations of the nominal arm in every form; with the arm nothing needs to
/// be asked.
#[test]
fn orientations() {
    let arm = robot();
    let target = arm.nominal_target();
    let poses: Vec<(Vec<f64>, nalgebra::Rotation3<f64>)> = rows()
        .into_iter()
        .map(|row| {
            let q: Vec<f64> = row[..6].iter().map(|v| v.to_radians()).collect();
            (row, nalgebra::Rotation3::from_matrix_unchecked(target(&q).rotation))
        })
        .collect();
    let table = |names: &str, of: &dyn Fn(&nalgebra::Rotation3<f64>) -> Vec<f64>| {
        let rows: Vec<Vec<f64>> =
            poses.iter().map(|(row, turn)| [row.clone(), of(turn)].concat()).collect();
        let header = if names.is_empty() {
            String::new()
        } else {
            format!("j1,j2,j3,j4,j5,j6,x,y,z,{names}\n")
        };
        text(&header, &rows, ",", ".").into_bytes()
    };
    let quaternion =
        |turn: &nalgebra::Rotation3<f64>| nalgebra::UnitQuaternion::from_rotation_matrix(turn);
    let expected = imported(
        &vec![(
            "xyzw.csv",
            table("qx,qy,qz,qw", &|r| {
                let q = quaternion(r);
                vec![q.i, q.j, q.k, q.w]
            }),
        )],
        None,
        &ImportOptions::default(),
    )
    .csv;
    let first = |r: &nalgebra::Rotation3<f64>| {
        let q = quaternion(r);
        vec![q.w, q.i, q.j, q.k]
    };
    let vector = |r: &nalgebra::Rotation3<f64>| {
        let v = r.scaled_axis();
        vec![v.x, v.y, v.z]
    };
    let rpy = |r: &nalgebra::Rotation3<f64>| {
        let (a, b, c) = r.euler_angles();
        vec![a, b, c]
    };
    let kuka = |r: &nalgebra::Rotation3<f64>| {
        let (a, b, c) = r.euler_angles();
        [c, b, a].map(f64::to_degrees).to_vec()
    };
    let matrix = |r: &nalgebra::Rotation3<f64>| r.matrix().transpose().iter().copied().collect();
    // Names, cells, and the flag that is needed without an arm.
    let cases: Vec<(&str, Vec<u8>, Option<&str>)> = vec![
        ("scalar first", table("qw,qx,qy,qz", &first), None),
        ("q0 to q3", table("q0,q1,q2,q3", &first), None),
        ("no names", table("", &first), Some("wxyz")),
        ("vector", table("rx,ry,rz", &vector), Some("vector-rad")),
        ("angles", table("rx,ry,rz", &rpy), Some("rpy-rad")),
        ("roll", table("roll,pitch,yaw", &rpy), None),
        ("kuka", table("A,B,C", &kuka), None),
        ("matrix", table("r11,r12,r13,r21,r22,r23,r31,r32,r33", &matrix), None),
    ];
    for (name, bytes, flag) in cases {
        let files = vec![("o.csv", bytes)];
        let with_arm = imported(&files, Some(&arm), &ImportOptions::default());
        near(&with_arm.csv, &expected, name);
        let options =
            ImportOptions { orientation: flag.map(str::to_owned), ..ImportOptions::default() };
        near(&imported(&files, None, &options).csv, &expected, name);
        let (_folder, paths) = written(&files);
        let again = import(
            &paths,
            None,
            Some((Path::new("i.toml"), &with_arm.config)),
            &ImportOptions::default(),
        );
        assert_eq!(again.unwrap().csv, with_arm.csv, "{name}");
        if let Some(flag) = flag {
            let message = refused(&files, None, &ImportOptions::default());
            assert!(message.contains(&format!("--orientation {flag}")), "{name}: {message}");
        }
    }
}

/// The same cells, numbers within the last decimals.
fn near(found: &str, expected: &str, name: &str) {
    assert_eq!(found.lines().count(), expected.lines().count(), "{name}");
    for (a, b) in found.lines().zip(expected.lines()) {
        for (a, b) in a.split(',').zip(b.split(',')) {
            match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(x), Ok(y)) => assert!((x - y).abs() < 1e-8, "{name}: {x} and {y}"),
                _ => assert_eq!(a, b, "{name}"),
            }
        }
    }
}

/// An arm settles what numbers leave open.
#[test]
fn the_arm_settles_units() {
    let small: Vec<Vec<f64>> = scaled(true, false)
        .iter()
        .map(|row| row.iter().enumerate().map(|(i, v)| if i < 6 { v * 2.5 } else { *v }).collect())
        .collect();
    let header = "q1,q2,q3,q4,q5,q6,x,y,z\n";
    let files = vec![("q.csv", text(header, &small, ",", ".").into_bytes())];
    let message = refused(&files, None, &ImportOptions::default());
    assert!(
        message.contains("degrees or radians?") && message.contains("--angles rad"),
        "{message}"
    );
    // 12 radians are beyond the limits of a joint; 12 degrees are not.
    let limits =
        ROBOT.replace("theta_offset_deg", "limits_deg = [-180.0, 180.0]\ntheta_offset_deg");
    let arm = Robot::parse(Path::new("robot.toml"), &limits).unwrap();
    let found = imported(&files, Some(&arm), &ImportOptions::default());
    let unit = found.columns.iter().find(|c| c.to == "q1").unwrap();
    assert_eq!(unit.unit.as_deref(), Some("deg"), "{}", unit.because);
    assert!(unit.because.contains("limits"), "{}", unit.because);
    // Headings that the arm contradicts are followed, and it is said.
    let wrong = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x,y,z\n";
    let files = vec![("q.csv", text(wrong, &scaled(true, false), ",", ".").into_bytes())];
    let found = imported(&files, Some(&robot()), &ImportOptions::default());
    assert!(
        found.warnings.iter().any(|w| w.contains("but in rad distances")),
        "{:?}",
        found.warnings
    );
}

#[test]
fn flags_and_repetitions() {
    let twice: Vec<Vec<f64>> = rows().iter().flat_map(|row| [row.clone(), row.clone()]).collect();
    let files = vec![("anything.csv", text("a,b,c,d,e,f,u,v,w\n", &twice, ",", ".").into_bytes())];
    let message = refused(&files, None, &ImportOptions::default());
    assert!(
        message.contains("a, b, c, d, e, f, u, v, w") && message.contains("--columns"),
        "{message}"
    );
    let columns = ["q=1-6", "x=u", "y=v", "z=9"].map(str::to_owned).to_vec();
    let options = ImportOptions { columns, ..ImportOptions::default() };
    let found = imported(&files, None, &options);
    assert_eq!((found.rows, found.poses), (36, 18));
    let options = ImportOptions { angles: Some(Unit::Rad), ..options };
    let found = imported(&files, None, &options);
    assert!(found.csv.lines().nth(1).unwrap().starts_with("-1718.8733854"), "{}", found.csv);
    // A gap in the middle of the table.
    let gap = plain().replace("313.725", "");
    let files = vec![("gap.csv", gap.into_bytes())];
    let message = refused(&files, None, &ImportOptions::default());
    assert!(message.contains("gap.csv:4, column x_mm: empty cell"), "{message}");
    let options = ImportOptions { skip_incomplete: true, ..ImportOptions::default() };
    let found = imported(&files, None, &options);
    assert_eq!(found.rows, 17);
    assert!(found.warnings[0].contains("lines 4"), "{:?}", found.warnings);
}

/// Every column is read in the unit that its own heading says.
#[test]
fn units_of_single_columns() {
    let arm = robot();
    let with = |at: usize, factor: f64| -> Vec<Vec<f64>> {
        let mut all = rows();
        all.iter_mut().for_each(|row| row[at] *= factor);
        all
    };
    let radian = 1_f64.to_radians();
    let cases = [
        ("q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_rad,x_mm,y_mm,z_mm\n", with(5, radian)),
        ("q1_rad,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm\n", with(0, radian)),
        ("q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_m\n", with(8, 1e-3)),
        ("q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_m,y_mm,z_mm\n", with(6, 1e-3)),
        ("q1,q2,q3,q4,q5,q6_rad,x,y,z\n", with(5, radian)),
        ("q1,q2,q3,q4,q5,q6,x,y,z_m\n", with(8, 1e-3)),
        ("q1,q2,q3,q4,q5,q6,x,y (ft),z\n", with(7, 1.0 / 304.8)),
        ("q1,q2,q3 [gon],q4,q5,q6,x,y,z\n", with(2, 1.0 / 0.9)),
    ];
    for (header, table) in cases {
        for arm in [None, Some(&arm)] {
            let files = vec![("m.csv", text(header, &table, ",", ".").into_bytes())];
            let found = imported(&files, arm, &ImportOptions::default());
            near(&found.csv, &plain(), header);
            assert!(found.warnings.is_empty(), "{header}: {:?}", found.warnings);
        }
    }
    // What is no unit that is known is asked for, with the column and the flag.
    for (header, says, flag) in [
        ("q1,q2 [counts],q3,q4,q5,q6,x,y,z\n", "column 2 \"q2 [counts]\": \"counts\"", "--angles"),
        (
            "q1,q2,q3,q4,q5,q6,x,y,z [furlong]\n",
            "column 9 \"z [furlong]\": \"furlong\"",
            "--lengths",
        ),
        ("q1,q2,q3,q4,q5,q6_mm,x,y,z\n", "column 6 \"q6_mm\" is in mm, but an angle", "--angles"),
    ] {
        let files = vec![("m.csv", text(header, &rows(), ",", ".").into_bytes())];
        let message = refused(&files, Some(&arm), &ImportOptions::default());
        assert!(message.contains(says) && message.contains(flag), "{header}: {message}");
    }
    let header = "q1 [counts],q2,q3,q4,q5,q6,x,y,z\n";
    let files = vec![("m.csv", text(header, &rows(), ",", ".").into_bytes())];
    let options = ImportOptions { angles: Some(Unit::Deg), ..ImportOptions::default() };
    assert_eq!(imported(&files, None, &options).csv, plain());
}

/// Lengths and angles that the arm contradicts are read in the one unit that agrees.
#[test]
fn the_arm_finds_other_units() {
    let arm = robot();
    let header = "q1,q2,q3,q4,q5,q6,x,y,z\n";
    let table = |angle: f64, length: f64| {
        let scale = |row: &Vec<f64>| -> Vec<f64> {
            let of = |(i, v): (usize, &f64)| if i < 6 { v / angle } else { v / length };
            row.iter().enumerate().map(of).collect()
        };
        let all: Vec<Vec<f64>> = rows().iter().map(scale).collect();
        text(header, &all, ",", ".").into_bytes()
    };
    for (angle, length) in
        [(1.0, 1e-3), (1.0, 10.0), (1.0, 25.4), (1.0, 304.8), (0.9, 1.0), (0.9, 25.4)]
    {
        let files = vec![("m.csv", table(angle, length))];
        let found = imported(&files, Some(&arm), &ImportOptions::default());
        near(&found.csv, &plain(), &format!("{angle} {length}"));
    }
    // No unit makes a span of kilometres the arm's.
    let files = vec![("m.csv", table(1.0, 1e-6))];
    let message = refused(&files, Some(&arm), &ImportOptions::default());
    assert!(message.contains("the arm reaches") && message.contains("--lengths"), "{message}");
    // Files one below the other are in one unit, by their headings or by their numbers.
    let rad = header.replace(",x", "_rad,x").replace("1,q", "1_rad,q");
    for (second, arm) in [
        (text(header, &scaled(true, false), ",", "."), None),
        (text(header, &scaled(true, false), ",", "."), Some(&arm)),
        (text(header, &scaled(false, true), ",", "."), Some(&arm)),
        (text(&rad, &scaled(true, false), ",", "."), None),
    ] {
        let files = vec![("a.csv", table(1.0, 1.0)), ("b.csv", second.into_bytes())];
        let message = refused(&files, arm, &ImportOptions::default());
        let units = message.contains("a.csv is in") && message.contains("b.csv in");
        assert!(units || message.contains("b.csv: other headings than"), "{message}");
    }
}

/// Cells may carry their unit.
#[test]
fn units_in_cells() {
    let cells = |row: &Vec<f64>| -> String {
        let of = |(i, v): (usize, &f64)| if i < 6 { format!("{v}°") } else { format!("{v} mm") };
        row.iter().enumerate().map(of).collect::<Vec<_>>().join(";") + "\n"
    };
    let table =
        "J1;J2;J3;J4;J5;J6;X;Y;Z\n".to_owned() + &rows().iter().map(cells).collect::<String>();
    let files = vec![("m.csv", table.clone().into_bytes())];
    assert_eq!(imported(&files, None, &ImportOptions::default()).csv, plain());
    let files = vec![("m.csv", table.replacen("°", " rad", 1).into_bytes())];
    let message = refused(&files, None, &ImportOptions::default());
    assert!(message.contains("m.csv:3") && message.contains("rad and deg"), "{message}");
}

/// Rows of other kinds stay, with what they say of themselves.
#[test]
fn rows_of_other_kinds() {
    let header = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm,kind,distance_mm,anchor,\
                  plate,hole,sigma_mm,torque1_nm\n";
    let mut table = header.to_owned();
    for (i, row) in rows().iter().enumerate() {
        let joints: Vec<String> = row[..6].iter().map(f64::to_string).collect();
        let point: Vec<String> = row[6..].iter().map(f64::to_string).collect();
        let rest = match i % 3 {
            0 => format!("{},point,,,,,0.02,1.5", point.join(",")),
            1 => format!(",,,distance,{}.25,A,,,0.03,2.5", 500 + i),
            _ => ",,,plate,,,P,03,0.04,3.5".to_owned(),
        };
        table += &format!("{},{rest}\n", joints.join(","));
    }
    for table in [table.clone(), table.replace(',', ";").replace('.', ",")] {
        let found = imported(
            &vec![("m.csv", table.into_bytes())],
            Some(&robot()),
            &ImportOptions::default(),
        );
        assert!(found.left_out.is_empty(), "{:?}", found.left_out);
        let lines: Vec<&str> = found.csv.lines().collect();
        assert_eq!(lines.len(), 19, "no row is lost");
        let cell = |line: usize, name: &str| {
            let at = lines[0].split(',').position(|n| n == name).unwrap();
            lines[line].split(',').nth(at).unwrap().to_owned()
        };
        assert_eq!((cell(2, "kind"), cell(2, "distance_mm")), ("distance".into(), "501.25".into()));
        assert_eq!((cell(3, "plate"), cell(3, "hole")), ("P".into(), "03".into()));
        assert_eq!((cell(3, "x_mm"), cell(3, "torque1_nm")), (String::new(), "3.5".into()));
        assert_eq!(cell(2, "sigma_mm"), "0.03");
    }
    // A point without its coordinates is still asked for.
    let gap = table.replacen(&format!("{}", rows()[0][6]), "", 1);
    let message = refused(&vec![("m.csv", gap.into_bytes())], None, &ImportOptions::default());
    assert!(message.contains("m.csv:2") && message.contains("empty cell"), "{message}");
}

/// Four columns a, b, c, d of length one are no angles of a KUKA.
#[test]
fn a_quaternion_called_a_to_d() {
    let arm = robot();
    let target = arm.nominal_target();
    let mut table = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm,a,b,c,d\n".to_owned();
    for row in rows() {
        let q: Vec<f64> = row[..6].iter().map(|v| v.to_radians()).collect();
        let turn = nalgebra::Rotation3::from_matrix_unchecked(target(&q).rotation);
        let turn = nalgebra::UnitQuaternion::from_rotation_matrix(&turn);
        let numbers = row.iter().copied().chain([turn.w, turn.i, turn.j, turn.k]);
        table += &(numbers.map(|v| v.to_string()).collect::<Vec<_>>().join(",") + "\n");
    }
    let files = vec![("m.csv", table.into_bytes())];
    let message = refused(&files, None, &ImportOptions::default());
    assert!(message.contains("--orientation xyzw") && message.contains("wxyz"), "{message}");
    let found = imported(&files, Some(&arm), &ImportOptions::default());
    let w = found.columns.iter().find(|c| c.to == "qw").unwrap();
    assert_eq!(w.name, "a", "{}", w.because);
}

/// What is no table, and what cannot be told: by name, with what to do.
#[test]
fn refusals() {
    let csv = |header: &str| text(header, &rows(), ",", ".").into_bytes();
    let arm = robot();
    let seven = "q1,q2,q3,q4,q5,q6,q7,x,y,z\n";
    let seventh: Vec<Vec<f64>> =
        rows().iter().map(|r| [&r[..6], &[1.0], &r[6..]].concat()).collect();
    let cases: Vec<(Files, Option<&Robot>, ImportOptions, &[&str])> = vec![
        (
            vec![("a.mat", b"MATLAB 5.0 MAT-file".to_vec())],
            None,
            ImportOptions::default(),
            &["a MATLAB file, not a table", "writematrix", "a.csv", "loadmat"],
        ),
        (vec![("b.mat", b"\x89HDF\r\n".to_vec())], None, ImportOptions::default(), &["h5py"]),
        (vec![("c.npy", b"\x93NUMPY".to_vec())], None, ImportOptions::default(), &["savetxt"]),
        (vec![("d.pdf", b"%PDF-1.4".to_vec())], None, ImportOptions::default(), &["a PDF"]),
        (
            vec![("e.bin", vec![0, 1, 2, 3, 0, 0, 0])],
            None,
            ImportOptions::default(),
            &["no text and no spreadsheet"],
        ),
        (
            vec![("f.xlsx", b"PK\x03\x04broken".to_vec())],
            None,
            ImportOptions::default(),
            &["no spreadsheet"],
        ),
        (
            vec![("robot.toml", ROBOT.into())],
            None,
            ImportOptions::default(),
            &["a TOML file, not a table", "--robot"],
        ),
        (
            vec![("g.txt", b"nothing but words\nand more\n".to_vec())],
            None,
            ImportOptions::default(),
            &["no rows of numbers"],
        ),
        (vec![("empty.csv", Vec::new())], None, ImportOptions::default(), &["no rows of numbers"]),
        (
            vec![(
                "h.csv",
                text("q1,q2,q3,q4,q5,q6,x,y,z\n", &scaled(true, true), ",", ",").into(),
            )],
            None,
            ImportOptions::default(),
            &["commas both between and inside numbers", "semicolons"],
        ),
        (
            vec![("i.csv", csv("q1,q2,q3,q4,q5,q6,a,b,c\n"))],
            None,
            ImportOptions::default(),
            &["no measured point found among q1, q2", "--columns x=HEADING"],
        ),
        (
            vec![("j.csv", csv("a,b,c,d,e,f,x,y,z\n"))],
            None,
            ImportOptions::default(),
            &["no joints found", "--columns q1="],
        ),
        (
            vec![("k.csv", text(seven, &seventh, ",", ".").into())],
            Some(&arm),
            ImportOptions::default(),
            &["7 columns look like joints, robot.toml has 6"],
        ),
        (
            vec![("l.csv", csv("q1,q2,q3,q4,q5,q6,x_nominal,y_nominal,z_nominal\n"))],
            None,
            ImportOptions::default(),
            &["are not what was measured"],
        ),
        (
            vec![("m.csv", plain().into())],
            None,
            ImportOptions { columns: vec!["q9x=1".into()], ..Default::default() },
            &["--columns q9x=: no such name", "names are q1.."],
        ),
        (
            vec![("n.csv", plain().into())],
            None,
            ImportOptions { columns: vec!["q1=nowhere".into()], ..Default::default() },
            &["no column nowhere", "q1_deg"],
        ),
        (
            vec![("n2.csv", plain().into())],
            None,
            ImportOptions { columns: vec!["q1=1".into(), "q2=1".into()], ..Default::default() },
            &["column 1 \"q1_deg\" is named twice, as q1 and as q2"],
        ),
        (
            vec![("n3.csv", plain().into())],
            None,
            ImportOptions { columns: vec!["xyz=7-99".into()], ..Default::default() },
            &["xyz=7-99: x, y and z are three columns", "xyz=7-9"],
        ),
        (
            vec![("n4.csv", plain().into())],
            None,
            ImportOptions { columns: vec!["q=6-1".into()], ..Default::default() },
            &["q=6-1: the range runs backwards", "q=1-6"],
        ),
        (
            vec![("n5.parquet", b"PAR1".to_vec())],
            None,
            ImportOptions::default(),
            &["a Parquet file", "n5.parquet').to_csv", "n5.csv"],
        ),
        (
            vec![("o.csv", plain().into())],
            None,
            ImportOptions { orientation: Some("euler".into()), ..Default::default() },
            &["--orientation euler", "rpy-deg"],
        ),
        (
            vec![("p.csv", plain().into())],
            None,
            ImportOptions { orientation: Some("xyzw".into()), ..Default::default() },
            &["no such columns"],
        ),
        (
            vec![("q.csv", plain().into()), ("r.csv", plain().into())],
            None,
            ImportOptions { join: JoinAsked::Key("Id".into()), ..Default::default() },
            &["no column Id"],
        ),
        (
            vec![("s.csv", format!("{}1,2,3\n4,5,6,7,8,9,1,2,3\n", plain()).into())],
            None,
            ImportOptions::default(),
            &["s.csv:20: 3 cells where other rows have 9"],
        ),
    ];
    for (files, robot, options, says) in cases {
        let message = refused(&files, robot, &options);
        for part in says {
            assert!(message.contains(part), "{}: {message}\nshould say {part}", files[0].0);
        }
    }
}

/// An import.toml of other files is refused, and says where they differ.
/// A payload in another unit is read in it, or is named among what is left out.
#[test]
fn payloads_in_their_own_unit() {
    let robot = robot();
    for (heading, factor) in [
        ("payload", Some(1.0)),
        ("Payload [kg]", Some(1.0)),
        ("payload_g", Some(1e-3)),
        ("Payload [lb]", Some(0.453_592_37)),
        ("Payload (lbs)", Some(0.453_592_37)),
        ("Payload [N]", None),
        ("Payload [foo]", None),
        ("Payload [mm]", None),
    ] {
        let line = |(i, line): (usize, &str)| match i {
            0 => format!("{line},{heading}\n"),
            _ => format!("{line},{}\n", 4 + i % 2),
        };
        let table: String = plain().lines().enumerate().map(line).collect();
        let files = vec![("table.csv", table.into_bytes())];
        let found = imported(&files, Some(&robot), &ImportOptions::default());
        let rows = Measurements::parse(Path::new("m.csv"), &found.csv, &robot).unwrap();
        let read = rows.rows[0].payload.unwrap_or(0.0);
        assert!((read - 5.0 * factor.unwrap_or(0.0)).abs() < 1e-9, "{heading}: {read}");
    }
}

/// Two rows a minute, over midnight, in the ways that people write times.
#[test]
fn times_go_on() {
    let robot = robot();
    let at = |k: usize| 23 * 60 + 56 + k / 2;
    let clock = |k: usize| format!("{:02}:{:02}:{:02}", at(k) / 60 % 24, at(k) % 60, 30 * (k % 2));
    let day = |k: usize| 5 + at(k) / 1440;
    let twelve = |k: usize| {
        let hour = at(k) / 60 % 24;
        let half = if hour < 12 { "AM" } else { "PM" };
        format!("{}:{:02}:{:02} {half}", (hour + 11) % 12 + 1, at(k) % 60, 30 * (k % 2))
    };
    let ways: [&dyn Fn(usize) -> String; 5] = [
        &clock,
        &|k| format!("2026-03-{:02}T{}+01:00", day(k), clock(k)),
        &|k| format!("{:02}.03.2026 {}", day(k), clock(k)),
        &|k| format!("3/{}/2026 {}", day(k), twelve(k)),
        &twelve,
    ];
    for way in ways {
        let mut k = 0;
        let mut table = String::new();
        for (line, text) in plain().lines().enumerate() {
            let cell = if line == 0 { "time".to_owned() } else { way(k) };
            k += usize::from(line > 0);
            table += &format!("{text},{cell}\n");
        }
        let done =
            imported(&vec![("m.csv", table.into())], Some(&robot), &ImportOptions::default());
        let read = Measurements::parse("m.csv".as_ref(), &done.csv, &robot).unwrap();
        let times: Vec<f64> = read.rows.iter().map(|row| row.time.unwrap()).collect();
        let expected: Vec<f64> = (0..k).map(|k| 30.0 * k as f64).collect();
        assert_eq!(times, expected, "{}", way(0));
    }
}

/// Two sessions, or two days by a clock without dates: that the order of the rows is another
/// than that of the times is said.
#[test]
fn times_that_go_back_are_said() {
    let robot = robot();
    let timed = |at: &dyn Fn(usize) -> String| {
        let cell = |line: usize| if line == 0 { "time_s".to_owned() } else { at(line) };
        plain().lines().enumerate().map(|(k, text)| format!("{text},{}\n", cell(k))).collect()
    };
    let warned = |table: String| {
        let done =
            imported(&vec![("m.csv", table.into())], Some(&robot), &ImportOptions::default());
        done.warnings.iter().any(|w| w.contains("times go back 1 times"))
    };
    assert!(!warned(timed(&|k| format!("{}", 20 * k))));
    assert!(warned(timed(&|k| format!("{}", 20 * (k % 10)))));
    assert!(warned(timed(&|k| format!("{}:20:{:02}", if k < 9 { 14 } else { 10 }, k))));
}

/// Whatever a heading holds, the import.toml that is written reads the file alike.
#[test]
fn headings_with_control_characters() {
    let robot = robot();
    let mut count = 0;
    for control in ["\u{c}", "\u{c}..\u{c}", "\u{b}", "\u{1}", "\u{1b}", "\u{7f}", "\u{85}"] {
        let table = plain().replacen("y_mm", &format!("y{control}_mm"), 1);
        let (_folder, files) = written(&vec![("table.csv", table.into_bytes())]);
        let Ok(first) = import(&files, Some(&robot), None, &ImportOptions::default()) else {
            continue;
        };
        let config = (Path::new("import.toml"), first.config.as_str());
        let again = import(&files, Some(&robot), Some(config), &ImportOptions::default());
        assert_eq!(again.expect("its own import.toml").csv, first.csv, "{control:?}");
        count += 1;
    }
    assert!(count > 3, "{count}");
}

#[test]
fn another_table_under_an_old_config() {
    let options = ImportOptions::default();
    let found = imported(&vec![("m.csv", plain().into())], None, &options);
    let refused = |bytes: &str, config: &str| {
        let (_folder, paths) = written(&vec![("m.csv", bytes.into())]);
        let error =
            import(&paths, None, Some((Path::new("import.toml"), config)), &options).unwrap_err();
        format!("{error} -> {}", error.help())
    };
    let swapped = plain().replacen("q1_deg,q2_deg", "q2_deg,q1_deg", 1);
    let message = refused(&swapped, &found.config);
    assert!(
        message.contains("q1: column 1 \"q1_deg\" is \"q1_deg\" here and \"q2_deg\" in"),
        "{message}"
    );
    for (from, to, says) in [
        ("q1 = ", "q17 = ", "q17 is no column"),
        ("column = 9", "column = 10", "has no column 10"),
        ("unit = \"mm\"", "unit = \"furlong\"", "unit \"furlong\""),
        ("import-config-1", "import-config-9", "schema"),
        ("column = 3", "colum = 3", "unknown field `colum`"),
        ("q6 = ", "#", "q1.. and x, y, z"),
    ] {
        let config = found.config.replacen(from, to, if says.contains("q1..") { 0 } else { 1 });
        let config = if says.contains("q1..") { config.replace("q1 = ", "# ") } else { config };
        let message = refused(&plain(), &config);
        assert!(message.contains(says), "{message}\nshould say {says}");
    }
}

/// The program writes both files, and does not write over an edited one.
#[test]
fn the_program() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("a.csv"),
        text("J1;J2;J3;J4;J5;J6;X;Y;Z\n", &scaled(true, false), ";", ","),
    )
    .unwrap();
    let run = |line: &str| {
        let mut command = assert_cmd::Command::cargo_bin("truearm").unwrap();
        command.current_dir(&folder).args(line.split(' ')).env("COLUMNS", "1000").output().unwrap()
    };
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let done = run("import a.csv --out out/m.csv");
    let said = String::from_utf8(done.stdout).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(said.contains("q1: column 1 \"J1\", rad, because |q| < 4.8"), "{said}");
    assert_eq!(read("out/m.csv"), plain());
    assert!(read("out/import.toml").contains("# q1: column 1 \"J1\", rad, because"));
    assert!(run("import a.csv --out out/m.csv").status.success(), "the same again");
    let own = run("import a.csv --out import.toml --force");
    assert_eq!(own.status.code(), Some(2), "the name of what says how");
    assert!(run("import a.csv --config out/import.toml --out again.csv").status.success());
    assert_eq!(read("again.csv"), plain());
    fs::write(folder.path().join("out/import.toml"), read("out/import.toml") + "# mine\n").unwrap();
    let done = run("import a.csv --out out/m.csv");
    assert_eq!(done.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&done.stderr).contains("--config out/import.toml"));
    assert!(run("import a.csv --out out/m.csv --force").status.success());
    assert!(!read("out/import.toml").contains("# mine"));
}

/// An arm that meets one point with its elbow up and down: what it is off by is all that is
/// between the two, and tells no unit.
#[test]
fn units_of_an_arm_that_meets_points_twice() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/ur10-ipa");
    let robot = Robot::read(&data.join("robot.toml")).unwrap();
    let rows = fs::read_to_string(data.join("series-b/measurements.csv")).unwrap();
    for (mm, unit) in [(1.0, Unit::Mm), (1000.0, Unit::M), (10.0, Unit::Cm), (25.4, Unit::Inch)] {
        for count in [40, 200] {
            let mut text = "J1,J2,J3,J4,J5,J6,X,Y,Z\n".to_owned();
            for line in rows.lines().skip(1).take(count) {
                let cells: Vec<f64> =
                    line.split(',').skip(1).take(9).map(|c| c.parse().unwrap()).collect();
                let cell = |(k, x): (usize, &f64)| (if k < 6 { *x } else { x / mm }).to_string();
                text += &cells.iter().enumerate().map(cell).collect::<Vec<_>>().join(",");
                text += "\n";
            }
            if matches!(unit, Unit::Mm | Unit::M) {
                let rows = text.split_once('\n').unwrap().1.to_owned();
                let files: Files = vec![("b.csv", rows.into_bytes())];
                let made = imported(&files, Some(&robot), &ImportOptions::default());
                let place = |to: &str| made.columns.iter().find(|c| c.to == to).unwrap().column;
                assert_eq!(["q1", "q6", "x", "z"].map(place), [1, 6, 7, 9], "without headings");
            }
            let files: Files = vec![("b.csv", text.into_bytes())];
            let made = imported(&files, Some(&robot), &ImportOptions::default());
            let x = made.columns.iter().find(|column| column.to == "x").unwrap();
            let word = [("mm", Unit::Mm), ("m", Unit::M), ("cm", Unit::Cm), ("in", Unit::Inch)];
            let word = word.iter().find(|(_, u)| *u == unit).map(|(word, _)| *word);
            assert_eq!(x.unit.as_deref(), word, "{count} rows: {}", x.because);
            assert!(made.warnings.is_empty(), "{:?}", made.warnings);
        }
    }
}

/// Files of one name in several folders are several series.
#[test]
fn series_of_files_of_one_name() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "q1_deg,q2_deg,x_mm,y_mm,z_mm\n1,2,3,4,5\n2,3,4,5,6\n";
    let paths = ["mon/data.csv", "tue/data.csv"].map(|name| folder.path().join(name));
    for path in &paths {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, rows).unwrap();
    }
    let options = ImportOptions { join: JoinAsked::Stack, ..ImportOptions::default() };
    let made = import(&paths, None, None, &options).unwrap();
    assert!(made.csv.contains(",mon/data\n") && made.csv.contains(",tue/data\n"), "{}", made.csv);
}

/// What the reader of measurements refuses is said where it is written.
#[test]
fn values_that_other_verbs_refuse() {
    let text = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm,temperature_c\n\
                0,0,0,0,0,0,100,0,0,9999\n10,0,0,0,0,0,0,100,0,20\n";
    let files: Files = vec![("m.csv", text.as_bytes().to_vec())];
    let made = imported(&files, Some(&robot()), &ImportOptions::default());
    let said = made.warnings.join("\n");
    assert!(said.contains("other verbs refuse it") && said.contains("temperature_c"), "{said}");
}
