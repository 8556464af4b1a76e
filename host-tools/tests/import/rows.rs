//! Rows and cells that are not what a table has most of.

use std::path::Path;

use crate::published::{plain, rows, scaled, text};
use crate::tables::{Files, imported, refused, robot, written};
use truearm_host::import::{ImportOptions, import};

/// Averages and the like are no poses.
#[test]
fn rows_that_sum_up_the_others() {
    let table = |heading: &str, label: &dyn Fn(usize) -> String, sums: &[&str]| -> Files {
        let mut table = String::new();
        for (line, text) in plain().lines().enumerate() {
            let front = if line == 0 { heading.to_owned() } else { label(line) };
            table += &format!("{front},{text}\n");
        }
        for label in sums {
            table += &format!("{label},1,2,3,4,5,6,7,8,9\n");
        }
        vec![("m.csv", table.into())]
    };
    let number = |i: usize| i.to_string();
    for (heading, label, sums) in [
        ("No", &number as &dyn Fn(usize) -> String, &["Average", "StdDev"] as &[&str]),
        ("Nr", &number, &["Mittelwert", "Standardabweichung", "Min", "Max"]),
        ("Name", &|i| format!("P{i}"), &["Std. Dev.", "RMS:", "sum", "Count"]),
        ("Name", &|_| "P1".to_owned(), &["Mean", "Sigma"]),
    ] {
        let found = imported(&table(heading, label, sums), None, &ImportOptions::default());
        assert_eq!(found.rows, 18, "{heading} {sums:?}");
        let said = found.warnings.iter().find(|w| w.contains("sum up the others")).unwrap();
        assert!(said.contains(sums[0]) && said.contains("line 20"), "{said}");
    }
    // A name that many rows have is none of a sum.
    let load = |i: usize| if i.is_multiple_of(3) { "max" } else { "none" }.to_owned();
    let found = imported(&table("load", &load, &[]), None, &ImportOptions::default());
    assert_eq!(found.rows, 18);
    // Nor is a kind of measurement that the last row alone is of.
    let last = |i: usize| if i == 18 { "range" } else { "touch" }.to_owned();
    let found = imported(&table("load", &last, &[]), None, &ImportOptions::default());
    assert_eq!(found.rows, 18);
}

/// truearm's own tables of rows that measured no point.
#[test]
fn kinds_without_points() {
    let table = |columns: &str, cells: &str| -> Files {
        let mut table = format!("q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,kind,{columns}\n");
        for row in rows() {
            let joints: Vec<String> = row[..6].iter().map(f64::to_string).collect();
            table += &format!("{},{cells}\n", joints.join(","));
        }
        vec![("m.csv", table.into())]
    };
    for (columns, cells) in [
        ("incl_x_deg,incl_y_deg,sigma_deg,marker", "inclination,-43.5,-12.25,0.005,level"),
        ("distance_mm,anchor", "distance,2002.9465,A"),
        ("surface", "touch,table"),
        ("camera,image,plate,hole,u_px,v_px,sigma_px", "pixel,cam,0,plate,A1,100.5,200.5,0.1"),
    ] {
        let files = table(columns, cells);
        for arm in [None, Some(&robot())] {
            let found = imported(&files, arm, &ImportOptions::default());
            assert_eq!((found.rows, found.left_out.len()), (18, 0), "{columns}");
            let mut kept: Vec<&str> =
                found.csv.lines().nth(1).unwrap().split(',').skip(6).collect();
            let mut given: Vec<&str> = cells.split(',').collect();
            kept.sort_unstable();
            given.sort_unstable();
            assert_eq!(kept, given, "{columns}");
            let (_folder, paths) = written(&files);
            let config = (Path::new("import.toml"), found.config.as_str());
            let again = import(&paths, arm, Some(config), &ImportOptions::default()).unwrap();
            assert_eq!(again.csv, found.csv, "{columns}");
            // A row of a point among them lacks it.
            let of_points = table(columns, &cells[cells.find(',').unwrap()..]);
            let (_folder, paths) = written(&of_points);
            let error = import(&paths, arm, Some(config), &ImportOptions::default()).unwrap_err();
            assert!(error.to_string().contains("no columns x, y, z"), "{columns}: {error}");
        }
    }
    // Without a kind they are points, whose coordinates are missing.
    let message = refused(&table("surface", ",table"), None, &ImportOptions::default());
    assert!(message.contains("no measured point found"), "{message}");
}

/// Lengths that are no coordinates, in the unit that their heading says.
#[test]
fn lengths_in_other_units() {
    for (heading, value) in [
        ("distance_m", "2.0029465"),
        ("distance [in]", "78.85616141732284"),
        ("Length (mm)", "2002.9465"),
        ("Abstand [cm]", "200.29465"),
    ] {
        let mut table = format!("J1,J2,J3,J4,J5,J6,kind,{heading},anchor\n");
        for row in rows() {
            let joints: Vec<String> = row[..6].iter().map(f64::to_string).collect();
            table += &format!("{},distance,{value},A\n", joints.join(","));
        }
        let files = vec![("m.csv", table.into())];
        let found = imported(&files, Some(&robot()), &ImportOptions::default());
        assert!(found.left_out.is_empty(), "{heading}: {:?}", found.left_out);
        let at = found.csv.lines().next().unwrap().split(',').position(|n| n == "distance_mm");
        let cell = found.csv.lines().nth(1).unwrap().split(',').nth(at.unwrap()).unwrap();
        assert!((cell.parse::<f64>().unwrap() - 2002.9465).abs() < 1e-6, "{heading}: {cell}");
        let (_folder, paths) = written(&files);
        let config = (Path::new("import.toml"), found.config.as_str());
        let again = import(&paths, Some(&robot()), Some(config), &ImportOptions::default());
        assert_eq!(again.unwrap().csv, found.csv, "{heading}");
    }
}

/// Of two columns of one thing the one that is called as in measurements.csv counts.
#[test]
fn its_own_name_comes_first() {
    for headings in ["distance_m,distance_mm", "distance_mm,distance_m"] {
        let mut table = format!("J1,J2,J3,J4,J5,J6,kind,{headings},anchor\n");
        for row in rows() {
            let joints: Vec<String> = row[..6].iter().map(f64::to_string).collect();
            let lengths = if headings.starts_with("distance_mm") { "500,1" } else { "1,500" };
            table += &format!("{},distance,{lengths},A\n", joints.join(","));
        }
        let files = vec![("m.csv", table.into())];
        let found = imported(&files, Some(&robot()), &ImportOptions::default());
        let at = found.csv.lines().next().unwrap().split(',').position(|n| n == "distance_mm");
        assert_eq!(found.csv.lines().nth(1).unwrap().split(',').nth(at.unwrap()), Some("500"));
    }
}

/// Joints in one file, corners of the images taken there in another.
#[test]
fn joints_beside_corners() {
    let (mut joints, mut corners) = (
        "Image,J1,J2,J3,J4,J5,J6\n".to_owned(),
        "image,kind,camera,plate,hole,u_px,v_px\n".to_owned(),
    );
    for (i, row) in rows().iter().enumerate() {
        let own: Vec<String> = row[..6].iter().map(f64::to_string).collect();
        joints += &format!("im{i},{}\n", own.join(","));
        for k in 0..3 {
            corners += &format!("im{i},pixel,cam,board,C{k},{}.5,{}.25\n", 100 + 10 * k, 200 + i);
        }
    }
    let files = vec![("q.csv", joints.into()), ("corners.csv", corners.into())];
    let found = imported(&files, Some(&robot()), &ImportOptions::default());
    assert_eq!((found.rows, found.poses), (54, 18), "{}", found.csv);
    let header: Vec<&str> = found.csv.lines().next().unwrap().split(',').collect();
    for column in ["q1_deg", "q6_deg", "kind", "image", "camera", "plate", "hole", "u_px", "v_px"] {
        assert!(header.contains(&column), "{header:?}");
    }
}

/// Standard deviations of points are kept in any table.
#[test]
fn sigma_without_kinds() {
    for (heading, factor) in [("sigma_mm", 1.0), ("Sigma [mm]", 1.0), ("sigma [um]", 1e-3)] {
        let line = |(i, line): (usize, &str)| match i {
            0 => format!("{line},{heading}\n"),
            _ => format!("{line},{}\n", 20 + i),
        };
        let table: String = plain().lines().enumerate().map(line).collect();
        let found = imported(&vec![("m.csv", table.into())], None, &ImportOptions::default());
        assert!(found.left_out.is_empty(), "{heading}: {:?}", found.left_out);
        let at = found.csv.lines().next().unwrap().split(',').position(|name| name == "sigma_mm");
        let cell = found.csv.lines().nth(1).unwrap().split(',').nth(at.unwrap()).unwrap();
        assert!((cell.parse::<f64>().unwrap() - 21.0 * factor).abs() < 1e-9, "{heading}: {cell}");
    }
}

/// What stands in a column that is called right and is no number, is named with its cell.
#[test]
fn cells_that_are_no_numbers() {
    let grouped = |value: f64, sign: &str| {
        let (whole, thousands) =
            (value.abs().round() as u64 % 1000, value.abs().round() as u64 / 1000);
        let minus = if value < 0.0 { "-" } else { "" };
        format!("{minus}{}{sign}{whole:03}", thousands + 1)
    };
    let table = |header: &str, delimiter: &str, decimal: &str, sign: &str| -> Files {
        let mut table = header.replace(';', delimiter);
        for row in rows() {
            let joints = row[..6].iter().map(|v| v.to_string().replace('.', decimal));
            let point = row[6..].iter().map(|v| format!("\"{}\"", grouped(*v, sign)));
            table += &(joints.chain(point).collect::<Vec<_>>().join(delimiter) + "\n");
        }
        vec![("m.csv", table.into())]
    };
    let header = "J1;J2;J3;J4;J5;J6;X [mm];Y [mm];Z [mm]\n";
    for (delimiter, decimal, sign, word) in [(",", ".", ",", "point"), (";", ",", ".", "comma")] {
        let files = table(header, delimiter, decimal, sign);
        let message = refused(&files, Some(&robot()), &ImportOptions::default());
        assert!(message.contains("m.csv:2, column X [mm]: \"1"), "{message}");
        assert!(message.contains(&format!("decimal {word}")), "{message}");
    }
    // Blanks between thousands, and a fraction behind them.
    let blanks: Vec<Vec<f64>> = rows();
    let mut german = "J1;J2;J3;J4;J5;J6;X;Y;Z\n".to_owned();
    for row in &blanks {
        let cell = |(i, v): (usize, &f64)| {
            let text = format!("{:.4}", if i < 6 { *v } else { v + 2000.0 }).replace('.', ",");
            match text.find(',').filter(|at| *at == 4 && i >= 6) {
                Some(_) => format!("{}\u{a0}{}", &text[..1], &text[1..]),
                None => text,
            }
        };
        german += &(row.iter().enumerate().map(cell).collect::<Vec<_>>().join(";") + "\n");
    }
    let found = imported(&vec![("m.csv", german.into())], None, &ImportOptions::default());
    let first: Vec<&str> = found.csv.lines().nth(1).unwrap().split(',').collect();
    assert!((first[6].parse::<f64>().unwrap() - rows()[0][6] - 2000.0).abs() < 1e-3, "{first:?}");
}

/// `#` is a sign of comments, and a heading of what rows are counted by.
#[test]
fn a_column_called_by_the_sign_of_comments() {
    let counted = |delimiter: &str| {
        let mut table =
            plain().lines().next().unwrap().replacen("q1", "#,q1", 1).replace(',', delimiter)
                + "\n";
        for (i, line) in plain().lines().skip(1).enumerate() {
            table += &(format!("P{},{line}", i + 1).replace(',', delimiter) + "\n");
        }
        table
    };
    for delimiter in [",", ";", "\t"] {
        let files = vec![("m.csv", counted(delimiter).into_bytes())];
        assert_eq!(imported(&files, None, &ImportOptions::default()).csv, plain());
    }
    let files = vec![("m.txt", format!("# {}", plain().replace(',', " ")).into_bytes())];
    assert_eq!(imported(&files, None, &ImportOptions::default()).csv, plain());
}

/// Remarks above a table say its units as headings do.
#[test]
fn units_in_remarks() {
    let inches: Vec<Vec<f64>> = rows()
        .iter()
        .map(|row| row.iter().enumerate().map(|(i, v)| if i < 6 { *v } else { v / 25.4 }).collect())
        .collect();
    let header = "q1,q2,q3,q4,q5,q6,x,y,z\n";
    let table =
        "Measure Report\nPart: tool,Units: Inches\n".to_owned() + &text(header, &inches, ",", ".");
    let found = imported(&vec![("m.csv", table.into())], None, &ImportOptions::default());
    let x = found.columns.iter().find(|c| c.to == "x").unwrap();
    assert_eq!((x.unit.as_deref(), x.because.as_str()), (Some("in"), "line 2 says in"));
}

/// An import.toml of a table in other units is followed, and contradicted.
#[test]
fn an_old_config_that_the_arm_contradicts() {
    let header = "q1,q2,q3,q4,q5,q6,x,y,z\n";
    let table = |radians, metres| -> Files {
        vec![("m.csv", text(header, &scaled(radians, metres), ",", ".").into_bytes())]
    };
    let first = imported(&table(false, false), Some(&robot()), &ImportOptions::default());
    let config = (Path::new("import.toml"), first.config.as_str());
    for (radians, metres, says) in [
        (false, false, None),
        (false, true, Some("in m distances")),
        (true, false, Some("in rad distances")),
    ] {
        let (_folder, paths) = written(&table(radians, metres));
        let again =
            import(&paths, Some(&robot()), Some(config), &ImportOptions::default()).unwrap();
        match says {
            None => assert!(again.warnings.is_empty(), "{:?}", again.warnings),
            Some(says) => {
                assert!(again.warnings.iter().any(|w| w.contains(says)), "{:?}", again.warnings)
            }
        }
    }
}
