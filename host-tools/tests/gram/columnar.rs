//! Measurements in Parquet files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, GzipLevel, ZstdLevel};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DoubleType, FloatType, Int32Type, Int64Type,
};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use truearm_host::identify::{Options, identify};
use truearm_host::model::{Measurements, Robot};

use crate::parts::measured;
use crate::pieces::in_pieces;
use crate::simulated::{UR10_LIKE, robot};

/// The values of a column, some of which may be missing.
enum Values {
    Double(Vec<Option<f64>>),
    Float(Vec<Option<f64>>),
    Int(Vec<Option<i32>>),
    Long(Vec<Option<i64>>),
    Text(Vec<Option<String>>),
    Bool(Vec<bool>),
    /// Written as a timestamp, and as a list.
    Time(Vec<i64>),
    List(Vec<f64>),
}

impl Values {
    fn stated(&self, name: &str) -> String {
        match self {
            Self::Double(_) => format!("optional double {name};"),
            Self::Float(_) => format!("optional float {name};"),
            Self::Int(_) => format!("optional int32 {name};"),
            Self::Long(_) => format!("optional int64 {name};"),
            Self::Text(_) => format!("optional binary {name} (STRING);"),
            Self::Bool(_) => format!("required boolean {name};"),
            Self::Time(_) => format!("required int64 {name} (TIMESTAMP(MILLIS,true));"),
            Self::List(_) => format!("repeated double {name};"),
        }
    }
}

fn levels<T: Clone>(values: &[Option<T>]) -> (Vec<T>, Vec<i16>) {
    let there = values.iter().flatten().cloned().collect();
    (there, values.iter().map(|v| i16::from(v.is_some())).collect())
}

/// A file of these columns, `group` rows in each group.
fn write(path: &Path, columns: &[(&str, Values)], compression: Compression) {
    let fields: String = columns.iter().map(|(name, values)| values.stated(name)).collect();
    let schema = Arc::new(parse_message_type(&format!("message rows {{ {fields} }}")).unwrap());
    let properties = WriterProperties::builder().set_compression(compression).build();
    let file = std::fs::File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties)).unwrap();
    let length = columns.iter().map(|(_, values)| match values {
        Values::Double(v) | Values::Float(v) => v.len(),
        Values::Int(v) => v.len(),
        Values::Long(v) => v.len(),
        Values::Text(v) => v.len(),
        Values::Bool(v) => v.len(),
        Values::Time(v) => v.len(),
        Values::List(v) => v.len(),
    });
    let length = length.max().unwrap_or_default();
    // Three groups, the last one short, and more rows than are held at once in the first ones.
    let group = (length * 2 / 5).max(1);
    for from in (0..length).step_by(group) {
        let rows = from..(from + group).min(length);
        let mut next = writer.next_row_group().unwrap();
        for (_, values) in columns {
            let mut column = next.next_column().unwrap().unwrap();
            match values {
                Values::Double(v) => {
                    let (v, d) = levels(&v[rows.clone()]);
                    column.typed::<DoubleType>().write_batch(&v, Some(&d), None).unwrap();
                }
                Values::Float(v) => {
                    let (v, d) = levels(&v[rows.clone()]);
                    let v: Vec<f32> = v.iter().map(|v| *v as f32).collect();
                    column.typed::<FloatType>().write_batch(&v, Some(&d), None).unwrap();
                }
                Values::Int(v) => {
                    let (v, d) = levels(&v[rows.clone()]);
                    column.typed::<Int32Type>().write_batch(&v, Some(&d), None).unwrap();
                }
                Values::Long(v) => {
                    let (v, d) = levels(&v[rows.clone()]);
                    column.typed::<Int64Type>().write_batch(&v, Some(&d), None).unwrap();
                }
                Values::Text(v) => {
                    let (v, d) = levels(&v[rows.clone()]);
                    let v: Vec<ByteArray> = v.iter().map(|v| v.as_str().into()).collect();
                    column.typed::<ByteArrayType>().write_batch(&v, Some(&d), None).unwrap();
                }
                Values::Bool(v) => {
                    column.typed::<BoolType>().write_batch(&v[rows.clone()], None, None).unwrap();
                }
                Values::Time(v) => {
                    column.typed::<Int64Type>().write_batch(&v[rows.clone()], None, None).unwrap();
                }
                Values::List(v) => {
                    let v = &v[rows.clone()];
                    let (d, r) = (vec![1; v.len()], vec![0; v.len()]);
                    column.typed::<DoubleType>().write_batch(v, Some(&d), Some(&r)).unwrap();
                }
            }
            column.close().unwrap();
        }
        next.close().unwrap();
    }
    writer.close().unwrap();
}

type Columns = Vec<(&'static str, Values)>;

const JOINTS: [&str; 6] = ["q1_deg", "q2_deg", "q3_deg", "q4_deg", "q5_deg", "q6_deg"];
const POINT: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

/// The same rows as a text and as columns of numbers and labels.
fn both(rows: usize) -> (Robot, String, Columns) {
    let (robot, header, lines) = measured(rows);
    assert_eq!(
        header,
        JOINTS.iter().chain(&POINT).copied().collect::<Vec<_>>().join(",") + ",station,marker"
    );
    let cells: Vec<Vec<&str>> = lines.iter().map(|line| line.split(',').collect()).collect();
    let number = |k: usize| cells.iter().map(|row| Some(row[k].parse().unwrap())).collect();
    let text = |k: usize| cells.iter().map(|row| Some(row[k].to_owned())).collect();
    let mut columns: Vec<(&str, Values)> = Vec::new();
    for (k, name) in JOINTS.iter().chain(&POINT).enumerate() {
        columns.push((name, Values::Double(number(k))));
    }
    columns.push(("station", Values::Text(text(9))));
    columns.push(("marker", Values::Text(text(10))));
    (robot, header + "\n" + &lines.join("\n") + "\n", columns)
}

/// Column by column what stands in a text is what stands in a file of columns, whatever it is
/// compressed by; rows are numbered where a text has lines.
#[test]
fn columns_are_what_a_text_is() {
    let (robot, text, columns) = both(12_000);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.parquet");
    let read = Measurements::parse(&path, &text, &robot).unwrap();
    for compression in [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::LZ4_RAW,
        Compression::GZIP(GzipLevel::default()),
        Compression::ZSTD(ZstdLevel::default()),
    ] {
        write(&path, &columns, compression);
        let found = Measurements::read(&path, &robot).unwrap();
        assert_eq!((found.poses, &found.stations), (read.poses, &read.stations));
        assert_eq!(found.warnings, read.warnings);
        assert_eq!(found.rows.len(), read.rows.len());
        for (k, (a, b)) in found.rows.iter().zip(&read.rows).enumerate() {
            assert_eq!(a.line, k + 1);
            assert_eq!(truearm_host::model::Row { line: b.line, ..a.clone() }, *b);
        }
    }
    let csv = folder.path().join("rows.csv");
    std::fs::write(&csv, &text).unwrap();
    let both = [&path, &csv].map(|path: &PathBuf| {
        in_pieces(&robot, std::slice::from_ref(path), &Options::default()).unwrap().found.model
    });
    // Other rows are drawn, for lines are not rows.
    assert!(crate::parts::apart(&both[0], &both[1]) < 1e-6);
}

/// Other types of numbers, labels that are numbers, missing values where they may be, columns
/// that nobody asks for.
#[test]
fn numbers_of_any_type() {
    let (robot, text, mut columns) = both(60);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.parquet");
    columns.truncate(9);
    let count = 60;
    columns
        .push(("station", Values::Long((0..count).map(|k| Some(i64::from(k % 2 == 0))).collect())));
    columns
        .push(("payload_kg", Values::Int((0..count).map(|k| (k % 3 != 0).then_some(2)).collect())));
    columns.push((
        "temperature_c",
        Values::Float((0..count).map(|k| Some(20.0 + f64::from(k as u8))).collect()),
    ));
    columns.push((
        "operator",
        Values::Text((0..count).map(|k| (k % 2 == 0).then(|| format!("name {k}"))).collect()),
    ));
    write(&path, &columns, Compression::SNAPPY);
    let found = Measurements::read(&path, &robot).unwrap();
    assert_eq!(found.stations, ["1", "0"]);
    assert_eq!(found.rows[0].payload, None);
    assert_eq!(found.rows[1].payload, Some(2.0));
    assert_eq!(found.rows[5].temperature, Some(25.0));
    assert_eq!(found.extra_columns, ["operator"]);
    let plain = Measurements::parse(&path, &text, &robot).unwrap();
    assert!(
        found.rows.iter().zip(&plain.rows).all(|(a, b)| a.q == b.q && a.measured == b.measured)
    );
}

/// Columns that nobody asks for may be anything.
#[test]
fn what_is_not_asked_for_may_be_anything() {
    let (robot, _, mut columns) = both(60);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.parquet");
    columns.push(("written", Values::Time(vec![0; 60])));
    columns.push(("forces", Values::List(vec![0.0; 60])));
    columns.push(("good", Values::Bool(vec![true; 60])));
    write(&path, &columns, Compression::SNAPPY);
    assert_eq!(Measurements::read(&path, &robot).unwrap().rows.len(), 60);
    let found = in_pieces(&robot, std::slice::from_ref(&path), &Options::default()).unwrap();
    let said = found.found.figures.warnings.concat();
    assert!(said.contains("columns not used: written, forces, good"), "{said}");
}

#[test]
fn what_is_no_number_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.parquet");
    let fails = |change: &dyn Fn(&mut Columns)| {
        let (robot, _, mut columns) = both(60);
        change(&mut columns);
        write(&path, &columns, Compression::SNAPPY);
        let error = Measurements::read(&path, &robot).map(|_| ()).unwrap_err();
        let same = in_pieces(&robot, std::slice::from_ref(&path), &Options::default()).map(|_| ());
        assert_eq!(same.unwrap_err().to_string(), error.to_string());
        error.to_string()
    };
    let told = |error: String, what: &str| {
        let error = error.replace(&path.display().to_string(), "rows.parquet");
        assert!(error.contains(what), "{error}");
    };
    told(
        fails(&|c| c[3].1 = Values::Double((0..60).map(|k| (k != 40).then_some(1.0)).collect())),
        "rows.parquet:41, column q4_deg: empty cell",
    );
    told(
        fails(&|c| {
            c[7].1 = Values::Double(
                (0..60).map(|k| Some([1.0, f64::NAN][usize::from(k == 9)])).collect(),
            )
        }),
        "rows.parquet:10, column y_mm: NaN is not a finite number",
    );
    told(fails(&|c| drop(c.remove(5))), "missing column q6_deg");
    told(
        fails(&|c| c.push(("time_s", Values::Time(vec![0; 60])))),
        "column time_s: a column of dates",
    );
    told(
        fails(&|c| c.push(("order", Values::List(vec![0.0; 60])))),
        "column order: a column of lists",
    );
    told(
        fails(&|c| c.push(("order", Values::Bool(vec![true; 60])))),
        "column order: a column of dates, times, decimals or other than numbers",
    );
    told(
        fails(&|c| c[0].1 = Values::Text((0..60).map(|k| Some(format!("{k} deg"))).collect())),
        "rows.parquet:1, column q1_deg: \"0 deg\" is not a number",
    );
}

/// No byte of a file that is wrong, and no end of it, is more than an error.
#[test]
fn damaged_files_are_errors() {
    let (robot, _, columns) = both(100);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.parquet");
    write(&path, &columns, Compression::SNAPPY);
    let sound = std::fs::read(&path).unwrap();
    let mut read = 0;
    let mut tried = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        read += usize::from(Measurements::read(&path, &robot).is_ok());
    };
    for cut in (4..sound.len()).step_by(sound.len() / 150) {
        tried(&sound[..cut]);
    }
    for at in (4..sound.len()).step_by(sound.len() / 1500) {
        for flip in [0x01, 0x80, 0xff] {
            let mut bytes = sound.clone();
            bytes[at] ^= flip;
            tried(&bytes);
        }
    }
    // A number that became another one is no error.
    assert!(read > 0);
}

#[test]
fn by_the_program_too() {
    let (_, _, columns) = both(400);
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("rows.parquet"), &columns, Compression::SNAPPY);
    std::fs::write(folder.path().join("robot.toml"), UR10_LIKE).unwrap();
    let run = |line: &str| {
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_truearm"));
        let ran = command.current_dir(&folder).args(line.split(' ')).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (ran.status.code(), text(&ran.stdout), text(&ran.stderr))
    };
    for line in ["identify robot.toml rows.parquet", "identify robot.toml rows.parquet --in-pieces"]
    {
        let (code, out, error) = run(line);
        assert!(code == Some(0) && out.contains("400 rows of 400 poses"), "{out}{error}");
    }
    // Where no table of columns is asked for.
    let (code, _, error) = run("identify rows.parquet rows.parquet");
    assert!(code == Some(1) && error.contains("Parquet"), "{error}");
    let robot = robot(UR10_LIKE);
    let data = Measurements::read(&folder.path().join("rows.parquet"), &robot).unwrap();
    identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap();
}
