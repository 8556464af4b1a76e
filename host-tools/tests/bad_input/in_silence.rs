//! What was once taken in silence.

use std::path::Path;

use truearm_host::model::{Measurements, Robot};

use crate::{read, run, table_8, write};

fn refused(text: &str) -> String {
    let robot = Robot::parse(Path::new("r.toml"), truearm_simulate::robots::UR10_LIKE).unwrap();
    let error = Measurements::parse(Path::new("m.csv"), text, &robot).unwrap_err();
    format!("{error} -> {}", error.help())
}

#[test]
fn a_part_of_a_quaternion() {
    let header = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm,qx,qy,qz,qw,sigma_deg";
    for missing in 0..4 {
        let mut cells = ["0.5", "0.5", "0.5", "0.5"];
        cells[missing] = "";
        let said = refused(&format!("{header}\n0,0,0,0,0,0,1,2,3,{},0.01\n", cells.join(",")));
        let name = ["qx", "qy", "qz", "qw"][missing];
        assert!(said.contains(&format!("m.csv:2, column {name}: empty cell")), "{said}");
    }
}

#[test]
fn a_pair_without_a_label() {
    let header = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,kind,pair,distance_mm";
    let rows = "0,0,0,0,0,0,pair,,100\n0,0,0,0,0,9,pair,,100\n";
    let said = refused(&format!("{header}\n{rows}"));
    assert!(
        said.contains("m.csv:2, column pair: a row of kind \"pair\" without a label"),
        "{said}"
    );
}

/// A station of one file and one of another that differ in case only are one, or badly named.
#[test]
fn stations_of_several_files() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    let labelled = |label: &str| {
        let line = |(k, line): (usize, &str)| {
            format!("{line},{}\n", if k == 0 { "station" } else { label })
        };
        rows.lines().enumerate().map(line).collect::<String>()
    };
    write(&folder, "a.csv", &labelled("Stand"));
    write(&folder, "b.csv", &labelled("stand"));
    let (status, said) = run(&folder, "identify robot.toml --data a.csv --data b.csv");
    assert!(status == 1 && said.contains("b.csv: station \"Stand\" and \"stand\""), "{said}");
}

/// Two outputs are two files.
#[test]
fn outputs_of_one_name() {
    let folder = table_8();
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --out .").0, 0);
    for line in [
        "export model.toml --urdf same --mdh same",
        "export model.toml --mdh same --dh ./same",
        "plan robot.toml --poses 20 --limits=-90:90,-90:90,-90:90,-90:90,-90:90,-90:90 --out same \
         --html same",
    ] {
        let (status, said) = run(&folder, line);
        assert!(status == 2 && said.contains("two outputs in one file"), "{line}: {status} {said}");
        assert!(!folder.path().join("same").exists(), "{line}");
    }
}

/// The result of a verb that prints it is no talk.
#[test]
fn quiet_keeps_what_was_asked_for() {
    let folder = table_8();
    for line in ["robot --preset ur10", "robot --list", "robot --init", "completions bash"] {
        let (status, said) = run(&folder, line);
        assert!(status == 0 && !said.is_empty(), "{line}");
        assert_eq!(run(&folder, &format!("{line} --quiet")), (0, said), "{line}");
    }
    assert_eq!(run(&folder, "identify robot.toml measurements.csv -q"), (0, String::new()));
}

/// What no controller takes corrects no path, either.
#[test]
fn a_model_that_no_controller_takes() {
    let folder = table_8();
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --out .").0, 0);
    let model = read(&folder, "model.toml");
    let key = model.lines().find(|line| line.starts_with("tool_point_mm")).unwrap();
    write(&folder, "open.toml", &model.replace(key, "tool_point_mm = 63.0"));
    write(&folder, "path.csv", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n0,-90,90,0,90,0\n");
    for line in [
        "pack open.toml --out arm.bin",
        "compensate open.toml path.csv --out corrected.csv",
        "export open.toml --mdh table.csv",
    ] {
        let (status, said) = run(&folder, line);
        assert!(status == 1 && said.contains("unknown to +-63 mm"), "{line}: {status} {said}");
    }
}

/// Outputs are asked for before the work is done, and what cannot be told of them is an error.
#[test]
fn counts_that_no_memory_holds() {
    let folder = table_8();
    for (option, count) in
        [("--candidates", "100000000000"), ("--poses", "18446744073709551615"), ("--poses", "0")]
    {
        let other = if option == "--poses" { "--candidates 100" } else { "--poses 20" };
        let line = format!("plan robot.toml {other} {option} {count} --out poses.csv");
        let (status, said) = run(&folder, &line);
        assert!(status == 2 && said.contains("whole number from 1 to"), "{line}: {said}");
    }
}

#[test]
fn pi_where_no_radians_are() {
    let folder = table_8();
    let table = "alpha_deg,a_mm,theta_offset_deg,d_mm\n";
    for (row, column) in [("pi/2,0,0,100", "alpha_deg"), ("0,0,-pi/2,100", "theta_offset_deg")] {
        write(&folder, "dh.csv", &format!("# of a data sheet\n{table}{row}\n"));
        let (status, said) = run(&folder, "robot --dh modified dh.csv");
        let place = format!("dh.csv:3, column {column}");
        assert!(status == 1 && said.contains(&place) && said.contains("radians"), "{said}");
    }
    write(&folder, "dh.csv", "alpha_rad,a_mm,theta_offset_rad,d_mm\npi/2,0,-pi/2,100\n");
    let (status, said) = run(&folder, "robot --dh modified dh.csv");
    assert!(status == 0 && said.contains("alpha_deg = 90"), "{said}");
}
