//! Two columns of one name: nobody can tell which is meant.

use crate::{read, run, table_8, write};

/// Measurements with headings as other people write them; `more` columns of zeros.
fn table(rows: &str, headings: &str, more: usize) -> String {
    let zeros = ",0.0".repeat(more);
    let data = rows.lines().skip(1).map(|line| format!("{line}{zeros}\n"));
    format!("{headings}\n{}", data.collect::<String>())
}

#[test]
fn columns_of_one_name_are_asked_for() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    let line = "import m.csv --robot robot.toml --angles deg --lengths mm --out out/m.csv";
    for (more, columns, flag, settled) in [
        (",X", 1, "--columns x=", "x=7,y=8,z=9"),
        (",x", 1, "--columns x=", "x=7,y=8,z=9"),
        (",J2", 1, "--columns q1=", "q=1-6"),
        (",Station,Station", 2, "--columns station=", "station=10"),
    ] {
        write(&folder, "m.csv", &table(&rows, &format!("J1,J2,J3,J4,J5,J6,X,Y,Z{more}"), columns));
        let (status, said) = run(&folder, line);
        assert!(status == 2 && said.contains(flag), "{more}: {status} {said}");
        assert!(!folder.path().join("out").exists(), "{more}");
        let (status, said) = run(&folder, &format!("{line} --columns {settled}"));
        assert_eq!(status, 0, "{more}: {said}");
        std::fs::remove_dir_all(folder.path().join("out")).unwrap();
    }
    // A name that was asked for must be one column's.
    let (status, said) = run(&folder, &format!("{line} --columns station=Station"));
    assert!(status == 2 && said.contains("are both called Station"), "{said}");
    // What nothing is made of may be there as often as it likes.
    write(&folder, "m.csv", &table(&rows, "J1,J2,J3,J4,J5,J6,X,Y,Z,Remark,Remark", 2));
    assert_eq!(run(&folder, line).0, 0);
}
