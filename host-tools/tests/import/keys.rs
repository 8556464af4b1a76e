//! Rows of two files belong together by labels that are the same, and by nothing less.

use crate::published::{plain, rows};
use crate::tables::{Files, imported, refused, robot};
use truearm_host::import::{ImportOptions, JoinAsked};

/// Joints in their order, points in the reverse one; columns of labels in front.
fn files(
    headings: [&str; 2],
    joint: &dyn Fn(usize) -> String,
    point: &dyn Fn(usize) -> String,
) -> Files {
    let mut joints = format!("{},q1,q2,q3,q4,q5,q6\n", headings[0]);
    let mut points = format!("{},x,y,z\n", headings[1]);
    let cells = |row: &[f64]| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let all = rows();
    for (i, row) in all.iter().enumerate() {
        joints += &format!("{},{}\n", joint(i + 1), cells(&row[..6]));
    }
    for (i, row) in all.iter().enumerate().rev() {
        points += &format!("{},{}\n", point(i + 1), cells(&row[6..]));
    }
    vec![("joints.csv", joints.into()), ("points.csv", points.into())]
}

fn with_points(mut files: Files, more: &[&str]) -> Files {
    for label in more {
        files[1].1.extend(format!("{label},9000,9000,9000\n").bytes());
    }
    files
}

/// The labels decide, whatever stands above them.
#[test]
fn the_same_labels_under_any_heading() {
    let p = |i: usize| format!("P{i}");
    let headings = [
        "Target",
        "Observation",
        "Item",
        "Feature",
        "Object",
        "Measurement",
        "Element",
        "Merkmal",
        "Messpunkt",
        "Punktname",
        "Pt",
        "SMR",
        "Frame",
        "Step",
    ];
    let mut cases: Vec<(String, Files)> =
        headings.iter().map(|h| ((*h).to_owned(), files(["Name", h], &p, &p))).collect();
    let number = |i: usize| i.to_string();
    // A count of the rows says less than what they are called.
    let counted = |i: usize| format!("{},P{i}", 19 - i);
    let named = |i: usize| format!("P{}_{}", i / 3, i % 3);
    let series = |i: usize| format!("T{}P{}", i % 2, i / 2);
    for (name, files) in [
        ("spelled otherwise", files(["Name", "Target"], &p, &|i| format!("p-{i:03}"))),
        ("numbers", files(["Step", "Item"], &number, &number)),
        ("with a point", files(["Pose", "Pose"], &number, &|i| format!("{i}.0"))),
        ("one a number", files(["Pose", "Feature"], &number, &|i| format!("A::P{i:03}"))),
        ("counted", files(["No,Name", "No,Target"], &|i| format!("{i},P{i}"), &counted)),
        ("two numbers", files(["Name", "Name"], &named, &named)),
        ("two series", files(["Name", "Target"], &series, &series)),
    ] {
        cases.push((name.to_owned(), files));
    }
    for (name, files) in cases {
        let found = imported(&files, None, &ImportOptions::default());
        let join = found.join.unwrap_or_default();
        assert!(join.contains("same labels"), "{name}: {join}");
        let csv: String = found
            .csv
            .lines()
            .map(|line| line.split(',').take(9).collect::<Vec<_>>().join(",") + "\n")
            .collect();
        assert_eq!(csv, plain(), "{name}");
        assert!(found.warnings.is_empty(), "{name}: {:?}", found.warnings);
    }
}

/// A label that is no other file's is a row without a partner, whatever number it ends in.
#[test]
fn labels_of_nobody() {
    let odd = ["P5_2", "REF1", "Home1", "N5"];
    let p = |i: usize| format!("P{i}");
    for (name, files) in [
        ("alike", files(["Name", "Name"], &p, &p)),
        ("numbers", files(["Pose", "Name"], &|i| i.to_string(), &|i| format!("P{i:03}"))),
    ] {
        let found = imported(&with_points(files, &odd), None, &ImportOptions::default());
        assert_eq!(found.csv, plain(), "{name}");
        let said = found.warnings.iter().find(|w| w.contains("without a partner")).unwrap();
        assert!(odd.iter().all(|label| said.contains(label)), "{name}: {said}");
    }
}

/// Where a number may be two labels', or labels are different, rows are put together by
/// position, and it is said.
#[test]
fn labels_that_are_not_the_same() {
    let series = |i: usize| format!("T{}P{}", 1 + (i - 1) / 9, 1 + (i - 1) % 9);
    let p = |i: usize| format!("P{i}");
    let word = |i: usize| format!("{}x", "abcdefghijklmnopqrs".chars().nth(i).unwrap());
    for (name, files) in [
        ("two series", files(["Name", "Name"], &p, &series)),
        ("numbers and two series", files(["Pose", "Name"], &|i| i.to_string(), &series)),
        ("letters", files(["Name", "Target"], &p, &word)),
    ] {
        let found = imported(&files, None, &ImportOptions::default());
        assert!(found.join.unwrap().starts_with("row by row"), "{name}");
        let said = found.warnings.iter().find(|w| w.contains("by their position or number"));
        let said = said.unwrap_or_else(|| panic!("{name}: {:?}", found.warnings));
        assert!(said.contains("Name\" (\"") && said.contains("--join ONE=OTHER"), "{name}: {said}");
    }
    let more = with_points(files(["Name", "Name"], &p, &series), &["T3P1"]);
    let message = refused(&more, None, &ImportOptions::default());
    assert!(message.contains("files of different lengths"), "{message}");
}

/// A pose that was measured several times has its label as often.
#[test]
fn poses_measured_several_times() {
    let p = |i: usize| format!("P{i}");
    for heading in ["Name", "Target"] {
        let mut both = files(["Name", heading], &p, &p);
        let again: Vec<u8> = both[1].1.splitn(2, |b| *b == b'\n').last().unwrap().to_vec();
        both[1].1.extend(again);
        let found = imported(&both, Some(&robot()), &ImportOptions::default());
        assert_eq!((found.rows, found.poses), (36, 18), "{heading}");
    }
}

#[test]
fn a_key_of_two_names() {
    let p = |i: usize| format!("P{i}");
    let both = files(["No,Name", "No,Target"], &|i| format!("{i},P{i}"), &p);
    let both = vec![
        both[0].clone(),
        ("points.csv", String::from_utf8(both[1].1.clone()).unwrap().replace("No,", "").into()),
    ];
    for key in ["Name=Target", "Target=Name", "name = target"] {
        let options = ImportOptions { join: JoinAsked::Key(key.to_owned()), ..Default::default() };
        let found = imported(&both, None, &options);
        assert_eq!(found.rows, 18, "{key}");
        assert!(found.join.unwrap().starts_with("on a key"), "{key}");
    }
    let options = ImportOptions { join: JoinAsked::Key("Name=Ziel".into()), ..Default::default() };
    let message = refused(&both, None, &options);
    assert!(message.contains("no column Name=Ziel") && message.contains("Target"), "{message}");
}
