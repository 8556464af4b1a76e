//! Times in the ways in which people write them, in seconds.

use rust_xlsxwriter::{Format, Workbook};

use crate::published::{plain, rows};
use crate::tables::{Files, imported, refused, robot};
use truearm_host::import::{ImportOptions, Imported};
use truearm_host::model::Measurements;

/// The cells in front of a row.
type Cells<'a> = &'a dyn Fn(usize) -> String;

/// The plain table with other columns in front.
fn timed(heading: &str, cells: Cells) -> Files {
    let mut table = String::new();
    for (line, text) in plain().lines().enumerate() {
        let front = if line == 0 { heading.to_owned() } else { cells(line - 1) };
        table += &format!("{front},{text}\n");
    }
    vec![("m.csv", table.into())]
}

fn times(found: &Imported) -> Vec<f64> {
    let read = Measurements::parse("m.csv".as_ref(), &found.csv, &robot()).unwrap();
    read.rows.iter().map(|row| row.time.unwrap()).collect()
}

fn every(step: f64) -> Vec<f64> {
    (0..rows().len()).map(|k| step * k as f64).collect()
}

/// What the heading says, and of two groups with a fraction the minutes and seconds.
#[test]
fn units_of_times() {
    let plain = |k: usize| (20 * k).to_string();
    let minutes = |k: usize| {
        let tenths = 371 * k;
        // One cell without its fraction does not become an hour and minutes.
        let whole = format!("{:02}:{:02}", tenths / 600, tenths / 10 % 60);
        if tenths.is_multiple_of(10) { whole } else { format!("{whole}.{}", tenths % 10) }
    };
    let cases: [(&str, Cells, f64); 9] = [
        ("time [min]", &plain, 1200.0),
        ("Zeit [min]", &plain, 1200.0),
        ("time_min", &plain, 1200.0),
        ("time (h)", &plain, 72_000.0),
        ("time [ms]", &plain, 0.02),
        ("time [s]", &plain, 20.0),
        ("t [min]", &plain, 1200.0),
        ("time", &plain, 20.0),
        ("time", &minutes, 37.1),
    ];
    for (heading, cells, step) in cases {
        let found = imported(&timed(heading, cells), Some(&robot()), &ImportOptions::default());
        let expected = every(step);
        let near = times(&found).iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near, "{heading}: {:?}", times(&found));
    }
    for (heading, unit) in
        [("time [counts]", "counts"), ("Zeit [furlong]", "furlong"), ("time [mm]", "mm")]
    {
        let files = timed(heading, &plain);
        let message = refused(&files, None, &ImportOptions::default());
        assert!(message.contains(&format!("\"{unit}\" is no unit of time")), "{message}");
        assert!(message.contains("--columns time=1"), "{message}");
        let columns = vec!["time=1".to_owned()];
        let options = ImportOptions { columns, ..ImportOptions::default() };
        assert_eq!(times(&imported(&files, None, &options)), every(20.0), "{heading}");
    }
}

/// Two days of ten rows a day apart.
#[test]
fn dates_in_a_column_of_their_own() {
    let clock = |k: usize| format!("{}:{:02}:00", 9 + k / 6, 10 * (k % 6));
    let day = |k: usize| 5 + k / 10;
    let expected: Vec<f64> =
        every(600.0).iter().enumerate().map(|(k, t)| t + 86_400.0 * (k / 10) as f64).collect();
    let cases: [(&str, Cells); 5] = [
        ("Date,Time", &|k| format!("2025-03-{:02},{}", day(k), clock(k))),
        ("Datum,Uhrzeit", &|k| format!("{:02}.03.2025,{}", day(k), clock(k))),
        ("time,date", &|k| format!("{},202503{:02}", clock(k), day(k))),
        ("Date,Time", &|k| format!("2025-03-{:02} 00:00:00,{}", day(k), clock(k))),
        ("Date,Time", &|k| format!("3/{}/2025,{} AM", day(k), clock(k))),
    ];
    for (heading, cells) in cases {
        let files = timed(heading, cells);
        let found = imported(&files, None, &ImportOptions::default());
        assert_eq!(times(&found), expected, "{heading}");
        assert!(found.warnings.is_empty(), "{heading}: {:?}", found.warnings);
        let config = (std::path::Path::new("import.toml"), found.config.as_str());
        let (_folder, paths) = crate::tables::written(&files);
        let again =
            truearm_host::import::import(&paths, None, Some(config), &ImportOptions::default());
        assert_eq!(again.unwrap().csv, found.csv, "{heading}");
    }
    for times in [&clock as Cells, &|k| k.to_string()] {
        let columns = vec!["date=1".to_owned()];
        let options = ImportOptions { columns, ..ImportOptions::default() };
        let files = timed("day,uptime", &|k| format!("2025-03-{:02},{}", day(k), times(k)));
        let message = refused(&files, None, &options);
        assert!(message.contains("a date belongs to a column of times of day"), "{message}");
    }
    // Nothing says which is the month.
    let found = imported(
        &timed("Date,Time", &|k| format!("3/{}/2025,{}", day(k), clock(k))),
        None,
        &ImportOptions::default(),
    );
    let said = found.warnings.iter().find(|w| w.contains("no date and time")).unwrap();
    assert!(said.contains("m.csv:2") && said.contains("\"3/5/2025\""), "{said}");
    assert_eq!(times(&found), every(600.0));
}

/// A spreadsheet makes the first of February of 1.2: no angle of 3,913,315,200 degrees.
#[test]
fn a_date_is_no_angle() {
    let mut book = Workbook::new();
    let sheet = book.add_worksheet();
    let date = Format::new().set_num_format("yyyy-mm-dd");
    for (column, name) in plain().lines().next().unwrap().split(',').enumerate() {
        sheet.write(0, column as u16, name).unwrap();
    }
    for (k, row) in rows().iter().enumerate() {
        for (column, value) in row.iter().enumerate() {
            sheet.write(k as u32 + 1, column as u16, *value).unwrap();
        }
    }
    sheet.write_number_with_format(3, 1, 45_689.0, &date).unwrap();
    let files = vec![("m.xlsx", book.save_to_buffer().unwrap())];
    let said = refused(&files, None, &ImportOptions::default());
    assert!(said.contains("2025-02-01"), "{said}");
}

#[test]
fn dates_and_times_of_a_spreadsheet() {
    let mut book = Workbook::new();
    let sheet = book.add_worksheet();
    let (date, clock) =
        (Format::new().set_num_format("yyyy-mm-dd"), Format::new().set_num_format("hh:mm:ss"));
    let header = plain().lines().next().unwrap().to_owned() + ",Date,Time";
    for (column, name) in header.split(',').enumerate() {
        sheet.write(0, column as u16, name).unwrap();
    }
    for (k, row) in rows().iter().enumerate() {
        let line = k as u32 + 1;
        for (column, value) in row.iter().enumerate() {
            sheet.write(line, column as u16, *value).unwrap();
        }
        let minute = 600.0 * k as f64 / 86_400.0;
        sheet.write_number_with_format(line, 9, 45_721.0 + (k / 10) as f64, &date).unwrap();
        sheet.write_number_with_format(line, 10, 0.375 + minute, &clock).unwrap();
    }
    let files = vec![("m.xlsx", book.save_to_buffer().unwrap())];
    let times = times(&imported(&files, None, &ImportOptions::default()));
    let expected = |k: usize| 600.0 * k as f64 + 86_400.0 * (k / 10) as f64;
    let near = times.iter().enumerate().all(|(k, time)| (time - expected(k)).abs() < 1e-3);
    assert!(near, "{times:?}");
}
