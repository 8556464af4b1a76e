//! Lines of a megabyte and tables of thousands of columns: what is quadratic in
//! them takes minutes, what is not takes a second.

use std::time::{Duration, Instant};

use crate::{read, run, table_8, write};

/// Generous on a busy machine, and far below what anything quadratic takes.
const SOON: Duration = Duration::from_secs(90);

fn soon(folder: &tempfile::TempDir, line: &str) -> (i32, String) {
    let start = Instant::now();
    let ran = run(folder, line);
    assert!(start.elapsed() < SOON, "{line}: {:?}", start.elapsed());
    assert!(ran.1.len() < 200_000, "{line}: says {} bytes", ran.1.len());
    ran
}

/// The measurements with so many columns more, of other names each.
fn widened(rows: &str, columns: usize) -> String {
    let names: String = (0..columns).map(|i| format!(",c{i}")).collect();
    let cells = ",7".repeat(columns);
    let line =
        |(i, line): (usize, &str)| format!("{line}{}\n", if i == 0 { &names } else { &cells });
    rows.lines().enumerate().map(line).collect()
}

#[test]
fn megabytes_in_a_line() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    let million = 1 << 20;
    let files = [
        ("fewer.csv", widened(&rows, million / 32)),
        ("commas.csv", ",".repeat(million) + "\n" + &",".repeat(million)),
        ("numbers.csv", "1,".repeat(million / 2) + "\n"),
        ("word.csv", "x".repeat(million) + "\n1\n"),
        ("words.csv", "x ".repeat(million / 2) + "\n1\n"),
        ("quotes.csv", "\"".repeat(million) + "\n"),
        ("cell.csv", rows.replacen(",", &format!(",{},", "x".repeat(million)), 9)),
        ("row.csv", rows.clone() + &"1,".repeat(million / 2) + "\n"),
    ];
    for (name, text) in &files {
        write(&folder, name, text);
    }
    run(&folder, "identify robot.toml measurements.csv --out .");
    for (name, _) in &files {
        for line in [
            format!("check robot.toml {name}"),
            format!("fk robot.toml {name} --out fk.csv --force"),
            format!("import {name} --out out/m.csv --force"),
        ] {
            soon(&folder, &line);
        }
    }
    // What makes sense of all that is read.
    write(&folder, "names.csv", &widened(&rows, million / 4));
    assert_eq!(soon(&folder, "fk robot.toml names.csv --out wide.csv").0, 0);
    assert_eq!(soon(&folder, "check robot.toml names.csv --fix fixed").0, 0);
    let line = "compensate model.toml names.csv --from joints --extrapolate --out told.csv";
    assert_eq!(soon(&folder, line).0, 0);
}

/// Numbers without headings among many others: the arm finds its own.
#[test]
fn many_columns_to_import() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    for columns in [300, 1200] {
        let line = |(i, line): (usize, &str)| {
            let noise = |c: usize| format!(",{}", ((i * 7919 + c * 104_729) % 1009) as f64 / 7.0);
            format!("{line}{}\n", (0..columns).map(noise).collect::<String>())
        };
        let text: String = rows.lines().skip(1).enumerate().map(line).collect();
        write(&folder, "m.csv", &text);
        let (status, said) =
            soon(&folder, "import m.csv --robot robot.toml --out out/m.csv --force");
        assert!(status == 0 && said.contains("q1: column 1"), "{columns}: {status} {said}");
    }
    // With headings, and rows that share a key.
    let named = |name: &str, from: usize, to: usize| {
        let keyed = rows.lines().enumerate().map(|(i, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            let (key, more) = match i {
                0 => ("id".to_owned(), (0..1500).map(|c| format!(",n{c}")).collect::<String>()),
                _ => (format!("P{i}"), ",1".repeat(1500)),
            };
            format!("{key},{}{more}\n", cells[from..to].join(","))
        });
        write(&folder, name, &keyed.collect::<String>());
    };
    named("q.csv", 0, 6);
    named("p.csv", 6, 9);
    let (status, said) = soon(&folder, "import q.csv p.csv --robot robot.toml --out two/m.csv");
    assert_eq!(status, 0, "{said}");
}

/// Labels that join files are looked up, not searched for.
#[test]
fn many_rows_to_join() {
    let folder = table_8();
    let count = 40_000;
    let row = |i: usize| [i as f64 * 1e-3, (i % 97) as f64, (i % 89) as f64, 4.0, 5.0, 6.0];
    let mut q = "id,J1,J2,J3,J4,J5,J6\n".to_owned();
    let mut p = "id,X,Y,Z\n".to_owned();
    for i in 0..count {
        let cells: Vec<String> = row(i).iter().map(f64::to_string).collect();
        q += &format!("P{i},{}\n", cells.join(","));
        p += &format!("P{i},{},{},{}\n", 100 + i % 300, 200 + i % 211, 300 + i % 97);
    }
    write(&folder, "q.csv", &q);
    write(&folder, "p.csv", &p);
    let line = "import q.csv p.csv --angles deg --lengths mm --out out/m.csv";
    let (status, said) = soon(&folder, line);
    assert_eq!(status, 0, "{said}");
}
