//! Remarks, empty lines and a row of units stand in tables of every kind and change
//! nothing.

use crate::{read, run, table_8, write};

/// A table with remarks above, between and behind its rows.
fn remarked(text: &str) -> String {
    let (header, rows) = text.split_once('\n').unwrap();
    let units: Vec<&str> = header
        .split(',')
        .map(|name| name.rsplit('_').next().filter(|u| ["mm", "deg"].contains(u)).unwrap_or("-"))
        .collect();
    let mut out = format!("# by hand, q1_deg,x_mm\n\n{header}\n{}\n", units.join(","));
    for row in rows.lines() {
        out += &format!("# 1,2,3\n\n{row}\n");
    }
    out + "# the end\n"
}

/// Where some rows have a temperature, the others are told what they are taken to have.
#[test]
fn what_is_taken_for_an_empty_cell_is_said() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    let with = |cell: fn(usize) -> &'static str| {
        let mut out = String::new();
        for (k, row) in rows.lines().enumerate() {
            let more = if k == 0 { "temperature_c" } else { cell(k) };
            out += &format!("{row},{more}\n");
        }
        write(&folder, "measurements.csv", &out);
        run(&folder, "identify robot.toml measurements.csv").1
    };
    let some = with(|k| if k % 3 == 2 { "" } else { "21.5" });
    assert!(some.contains("rows without temperature_c, first in line 3: 20 degrees"), "{some}");
    assert!(!with(|_| "21.5").contains("without temperature_c"));
    assert!(!with(|_| "").contains("without temperature_c"));
}

#[test]
fn remarks_change_nothing() {
    let folder = table_8();
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --out .").0, 0);
    let rows = read(&folder, "measurements.csv");
    let poses = "x_mm,y_mm,z_mm\n-400,-200,300\n-390,-210,310\n";
    let commanded =
        (1..=6).fold(rows.clone(), |t, j| t.replace(&format!("q{j}_"), &format!("cmd{j}_")));
    for (line, text) in [
        ("fk model.toml IN --out OUT", rows.as_str()),
        ("compensate model.toml IN --from joints --extrapolate --out OUT", &rows),
        ("ik model.toml IN --out OUT", poses),
        ("verify model.toml IN --out OUT", &commanded),
    ] {
        write(&folder, "plain.csv", text);
        write(&folder, "remarked.csv", &remarked(text));
        for name in ["plain", "remarked"] {
            let line = line.replace("IN", &format!("{name}.csv"));
            let line = line.replace("OUT", &format!("of-{name}.csv"));
            let (status, said) = run(&folder, &line);
            assert_eq!(status, 0, "{line}: {said}");
        }
        if line.starts_with("verify") {
            continue;
        }
        assert_eq!(read(&folder, "of-plain.csv"), read(&folder, "of-remarked.csv"), "{line}");
        for name in ["plain", "remarked"] {
            std::fs::remove_file(folder.path().join(format!("of-{name}.csv"))).unwrap();
        }
    }
    // What is wrong is in the line where it stands.
    write(&folder, "remarked.csv", &remarked(&rows.replacen("x_mm", "why_mm", 1)));
    let (status, said) = run(&folder, "verify model.toml remarked.csv");
    assert!(status == 1 && said.contains("remarked.csv:3"), "{said}");
}
