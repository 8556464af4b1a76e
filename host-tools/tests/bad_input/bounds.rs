//! Numbers of files that no instrument, clock or arm has, refused by name.

use crate::{read, run, table_8, write};

/// A column more with a value in its second row, and what is said of it.
#[test]
fn columns_without_sense() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    for (column, usual, value, words) in [
        ("time_s", "1", "1e300", "column time_s: 1e300 s"),
        ("time_s", "1", "-2e10", "column time_s"),
        ("time_s", "1", "1.7e12", "milliseconds"),
        ("order", "1", "1e300", "column order: order 1e300"),
        ("temperature_c", "20", "1e300", "column temperature_c"),
        ("payload_kg", "1", "1e300", "column payload_kg"),
        ("payload_kg", "1", "-1", "column payload_kg"),
        ("sigma_mm", "0.1", "1e-300", "column sigma_mm: sigma 1e-300"),
        ("sigma_mm", "0.1", "9e-7", "column sigma_mm: sigma 9e-7"),
        ("sigma_mm", "0.1", "1001", "column sigma_mm"),
        ("dir1", "1", "1e300", "column dir1"),
    ] {
        write(&folder, "m.csv", &with_column(&rows, column, usual, value));
        for verb in ["identify", "diagnose", "check"] {
            let (status, said) = run(&folder, &format!("{verb} robot.toml m.csv"));
            let at = "m.csv:3";
            assert!(status == 1 && said.contains(words) && said.contains(at), "{verb}: {said}");
        }
    }
}

/// A table with one more column, of which the second row has another value.
fn with_column(rows: &str, column: &str, usual: &str, value: &str) -> String {
    let line = |(i, line): (usize, &str)| match i {
        0 => format!("{line},{column}\n"),
        2 => format!("{line},{value}\n"),
        _ => format!("{line},{usual}\n"),
    };
    rows.lines().enumerate().map(line).collect()
}

/// What is just within the bounds ends soon, in a result or an error.
#[test]
fn at_the_bounds() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    for (column, usual, value) in [
        ("time_s", "1", "1e10"),
        ("order", "1", "-1e12"),
        ("sigma_mm", "0.1", "1e-6"),
        ("sigma_mm", "1e-6", "10"),
        ("temperature_c", "20", "120"),
        ("payload_kg", "0", "5000"),
    ] {
        write(&folder, "m.csv", &with_column(&rows, column, usual, value));
        for verb in ["identify", "diagnose", "check"] {
            let start = std::time::Instant::now();
            let (status, said) = run(&folder, &format!("{verb} robot.toml m.csv"));
            assert!([0, 1, 3, 4].contains(&status), "{verb} {column} {value}: {status} {said}");
            assert!(
                start.elapsed().as_secs() < 60,
                "{verb} {column} {value}: {:?}",
                start.elapsed()
            );
        }
    }
}

#[test]
fn robots_without_sense() {
    let folder = table_8();
    let robot = read(&folder, "robot.toml");
    let sigma = robot.lines().find(|l| l.starts_with("measurement_sigma_mm")).unwrap().to_owned();
    for (from, to, words) in [
        (sigma.as_str(), "measurement_sigma_mm = 1e-300", "measurement_sigma_mm = 1e-300"),
        (&sigma, "measurement_sigma_mm = 5e-7", "measurement_sigma_mm = 5e-7"),
        (&sigma, "measurement_sigma_mm = 1000.5", "measurement_sigma_mm = 1000.5"),
        ("[[joints]]", "[[joints]]\nlimits_deg = [-1e300, 1e300]", "limits [-1e300, 1e300]"),
    ] {
        write(&folder, "r.toml", &robot.replacen(from, to, 1));
        let (status, said) = run(&folder, "identify r.toml measurements.csv");
        assert!(status == 1 && said.contains(words), "{to}: {status} {said}");
    }
}

/// Hundreds of digits are not printed.
#[test]
fn long_numbers_are_shortened() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    let cell = rows.lines().nth(1).unwrap().split(',').nth(7).unwrap().to_owned();
    let (digits, word) = ("7".repeat(300), "x".repeat(5000));
    for wrong in [digits.clone(), format!("-{digits}"), format!("{digits}mm"), word] {
        write(&folder, "m.csv", &rows.replacen(&cell, &wrong, 1));
        let (status, said) = run(&folder, "check robot.toml m.csv");
        assert_eq!(status, 1, "{said}");
        let message = said.split("╭").next().unwrap();
        assert!(message.len() < 400, "{message}");
    }
    write(&folder, "m.csv", &rows);
    let (status, said) =
        run(&folder, &format!("compensate robot.toml m.csv --every 1{digits} --out o.yaml"));
    assert!(status != 0 && !said.contains(&digits), "{said}");
}

#[test]
fn a_model_without_sense() {
    let folder = table_8();
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --out .").0, 0);
    let model = read(&folder, "model.toml");
    let line = |key: &str| model.lines().find(|l| l.starts_with(key)).unwrap().to_owned();
    let frame = line("rotation_vector_deg");
    for (from, to, words) in [
        (
            frame.as_str(),
            "rotation_vector_deg = [nan, 0.0, 0.0]",
            "frame.rotation_vector_deg[1] is NaN",
        ),
        (
            &line("quaternion_xyzw"),
            "quaternion_xyzw = [nan, 0.0, 0.0, 1.0]",
            "quaternion_xyzw[1] is NaN",
        ),
        (&line("covered_deg"), "covered_deg = [10.0, -10.0]", "joint 1 covered from 10.0 to -10.0"),
        (&line("covered_deg"), "covered_deg = [-1e308, 1e308]", "joint 1 covered"),
    ] {
        write(&folder, "m.toml", &model.replacen(from, to, 1));
        for verb in [
            "fk m.toml measurements.csv --out o.csv",
            "export m.toml --json",
            "pack m.toml --out o.bin",
        ] {
            let (status, said) = run(&folder, verb);
            assert!(status == 1 && said.contains(words), "{verb}: {status} {said}");
        }
    }
    // Finite, and too large to compute with: nothing that is no number is written.
    let a = line("a_mm = 0.0");
    let far = model
        .replace("xyz_mm = [", "xyz_mm = [1e308, ")
        .replace(", 0.0]\n\n[[joints", "]\n\n[[joints");
    let corrected = model.rsplit_once(&a).map(|(head, tail)| format!("{head}a_mm = 1e308{tail}"));
    write(&folder, "far.toml", &corrected.unwrap_or(far));
    for (verb, out) in [
        ("fk far.toml measurements.csv --out far.csv", "far.csv"),
        ("export far.toml --mdh far-mdh.csv", "far-mdh.csv"),
        ("export far.toml --urdf far.urdf", "far.urdf"),
    ] {
        let (status, said) = run(&folder, verb);
        let text = std::fs::read_to_string(folder.path().join(out)).unwrap_or_default();
        for word in ["NaN", "inf"] {
            assert!(!text.contains(word), "{verb}: {status} {said}\n{text}");
        }
    }
}
