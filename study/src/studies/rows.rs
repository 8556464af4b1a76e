//! Time and memory of `identify` against the number of rows.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use parquet::basic::Compression;
use parquet::data_type::DoubleType;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm_host::files::Pieces;
use truearm_host::gram::{DRAWN, LARGE, identify_in_pieces};
use truearm_host::identify::{self, Identification};
use truearm_host::model::{Measurements, Robot};
use truearm_host::plot::{Axis, Panel, Series};

use super::Result;
use crate::simulated::{Truth, UR10_LIKE, robot, vector};

#[derive(Args)]
pub struct Options {
    /// Rows of the files
    #[arg(long, value_delimiter = ',', default_values_t = [1000, 10_000, 100_000, 1_000_000, 10_000_000])]
    rows: Vec<usize>,
    /// Another seed, another arm
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where to draw both, an SVG file
    #[arg(long)]
    figure: Option<PathBuf>,
    /// Identify from this file, in a process of its own, whose memory is its own
    #[arg(long, hide = true)]
    one: Option<PathBuf>,
    #[arg(long, hide = true)]
    in_pieces: bool,
}

/// Standard deviation of a coordinate, m, and share of gross errors.
const SIGMA: f64 = 3e-5;
const GROSS: f64 = 5e-4;
/// Rows of a group of the file.
const GROUP: usize = 200_000;
/// Fewer rows than are drawn are no pieces.
const FEWEST: usize = 50_000;

pub fn run(options: &Options) -> Result {
    let robot = robot(UR10_LIKE);
    if let Some(file) = &options.one {
        return one(&robot, file, options.in_pieces);
    }
    let folder = tempfile::tempdir()?;
    let mut all: [Vec<[f64; 3]>; 2] = Default::default();
    println!("| rows | all at once: s, MB | in pieces: s, MB | rounds | cross-validated, mm |");
    println!("|---|---|---|---|---|");
    for rows in &options.rows {
        let file = folder.path().join("rows.parquet");
        simulate(&robot, *rows, options.seed, &file)?;
        let ways = [*rows <= LARGE, *rows >= FEWEST];
        let mut told = [const { String::new() }; 2];
        let (mut error, mut passes) = (f64::NAN, String::new());
        for k in (0..2).filter(|k| ways[*k]) {
            let [seconds, megabytes, found, rounds] = apart(&file, k == 1)?;
            all[k].push([*rows as f64, seconds, megabytes]);
            told[k] = format!("{seconds:.2}, {megabytes:.0}");
            if error.is_finite() && (found / error - 1.0).abs() > 0.02 {
                return Err(format!("{rows} rows: {error} mm at once, {found} mm in pieces").into());
            }
            error = found;
            if rounds > 0.0 {
                passes = rounds.to_string();
            }
        }
        println!("| {rows} | {} | {} | {passes} | {error:.4} |", told[0], told[1]);
    }
    slopes(&all);
    match &options.figure {
        Some(path) => Ok(std::fs::write(path, truearm_host::plot::grid(&panels(&all), 2))?),
        None => Ok(()),
    }
}

/// Seconds, megabytes, the cross-validated error and the rounds of a process of its own.
fn apart(file: &Path, in_pieces: bool) -> Result<[f64; 4]> {
    let mut command = Command::new(std::env::current_exe()?);
    command.arg("rows").arg("--one").arg(file);
    if in_pieces {
        command.arg("--in-pieces");
    }
    let ran = command.output()?;
    let said = String::from_utf8_lossy(&ran.stdout);
    let numbers: Vec<f64> = said.split_whitespace().filter_map(|n| n.parse().ok()).collect();
    <[f64; 4]>::try_from(numbers)
        .map_err(|_| format!("{}{said}", String::from_utf8_lossy(&ran.stderr)).into())
}

fn one(robot: &Robot, file: &Path, in_pieces: bool) -> Result {
    let (start, options) = (Instant::now(), identify::Options::default());
    let found: Identification = match in_pieces {
        true => {
            let file = file.to_owned();
            let mut rows = Pieces::of(&[&file], robot)?;
            let sample = rows.sample(DRAWN)?;
            identify_in_pieces(&rows, &sample, &options, &|_, _| ())?
        }
        false => {
            let data = Measurements::read(file, robot)?;
            identify::identify(robot, &data, &options, &|_, _| ())?
        }
    };
    let error = found.model.provenance.cross_validated_rms_mm;
    let rounds = found.figures.drawn.map_or(0, |drawn| drawn.rounds);
    println!("{} {} {error} {rounds}", start.elapsed().as_secs_f64(), peak());
    Ok(())
}

/// The most memory that this process had, MB; none where the system does not say.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    number.map_or(f64::NAN, |kilobytes| kilobytes / 1e3)
}

/// A file of points of an arm off by its tolerances.
fn simulate(robot: &Robot, rows: usize, seed: u64, path: &Path) -> Result {
    let truth = Truth::draw(robot, 1, 1, &mut ChaCha8Rng::seed_from_u64(seed));
    let joints = robot.joints.len();
    let names = (1..=joints).map(|j| format!("q{j}_deg"));
    let names = names.chain(["x_mm", "y_mm", "z_mm"].map(str::to_owned));
    let fields: String = names.map(|name| format!("required double {name};")).collect();
    let schema = Arc::new(parse_message_type(&format!("message rows {{ {fields} }}"))?);
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(File::create(path)?, schema, Arc::new(properties))?;
    let row = |k: usize| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(k as u64 + 1);
        // What the file says is what the joints were: rounded first.
        let degrees = |_| (rng.random_range(-150.0..150.0_f64) * 1e4).round() / 1e4;
        let q: Vec<f64> = (0..joints).map(degrees).collect();
        let radians: Vec<f64> = q.iter().map(|q| q.to_radians()).collect();
        let gross = if rng.random_bool(GROSS) { 7e-3 } else { 0.0 };
        let mut point = truth.point(&radians, 0, 0) + vector(&mut rng) * SIGMA;
        point.x += gross;
        (q, point * 1e3)
    };
    for from in (0..rows).step_by(GROUP) {
        let group: Vec<_> = (from..(from + GROUP).min(rows)).into_par_iter().map(row).collect();
        let mut next = writer.next_row_group()?;
        for k in 0..joints + 3 {
            let value = |(q, point): &(Vec<f64>, nalgebra::Vector3<f64>)| match q.get(k) {
                Some(q) => *q,
                None => point[k - joints],
            };
            let values: Vec<f64> = group.iter().map(value).collect();
            let mut column = next.next_column()?.ok_or("no column")?;
            column.typed::<DoubleType>().write_batch(&values, None, None)?;
            column.close()?;
        }
        next.close()?;
    }
    writer.close()?;
    Ok(())
}

const NAMES: [&str; 2] = ["all at once", "in pieces"];

/// By which power of the rows each grows from its last but one number of rows to the last.
fn slopes(all: &[Vec<[f64; 3]>; 2]) {
    for (name, own) in NAMES.iter().zip(all) {
        let [.., a, b] = own.as_slice() else { continue };
        let slope = |k: usize| (b[k] / a[k]).ln() / (b[0] / a[0]).ln();
        println!(
            "{name}, from {} to {} rows: time grows by their power {:.2}, memory by {:.2}",
            a[0],
            b[0],
            slope(1),
            slope(2)
        );
    }
}

fn panels(all: &[Vec<[f64; 3]>; 2]) -> Vec<Panel> {
    let panel = |title: &str, up: &str, k: usize| {
        let series = NAMES.iter().zip(all).map(|(name, own)| {
            Series::line(*name, own.iter().map(|point| (point[0], point[k])).collect())
        });
        Panel::new(title, Axis::log("rows"), Axis::log(up), series.collect())
    };
    vec![panel("Time", "s", 1), panel("Memory", "MB", 2)]
}
