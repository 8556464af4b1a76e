use std::collections::HashMap;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;

use super::{Instrument, Values, Warming};

/// The rows of a `measurements.csv`, in SI units.
#[derive(Debug, Clone)]
pub struct Measurements {
    /// The file they came from.
    pub path: PathBuf,
    /// Files whose rows stand behind those of the first, and which their first row is.
    pub behind: Vec<(PathBuf, usize)>,
    /// One entry a data row, in file order.
    pub rows: Vec<Row>,
    /// Labels of the tracker stations; one empty label without the column.
    pub stations: Vec<String>,
    /// Labels of the markers; one empty label without the column.
    pub markers: Vec<String>,
    /// Places of markers in the last frame that are known, m; empty where none
    /// is.
    pub known_markers: Vec<Option<Vector3<f64>>>,
    /// The same of places that are a first guess.
    pub guessed_markers: Vec<Option<Vector3<f64>>>,
    /// What rows refer to beside the arm, as far as it is known.
    pub instruments: Vec<Instrument>,
    /// Where the arm stands in a station's frame if nothing measured says so.
    pub base: Pose<f64>,
    /// Number of distinct poses.
    pub poses: usize,
    /// Names of columns without a meaning to truearm.
    pub extra_columns: Vec<String>,
    /// Whether approach sides are those of the order of the rows: no column says them.
    pub directions_from_order: bool,
    /// Whether rows are numbered as they stand in the file: no column says when they were measured.
    pub order_from_rows: bool,
    /// Of each joint, how many of them the order left open and what was measured tells; empty
    /// where that was not asked.
    pub sides_found: Vec<usize>,
    /// Remarks for the user.
    pub warnings: Vec<String>,
}

/// What a row measured: the place of its kind in the table of kinds. The first
/// is the point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct KindId(pub u8);

/// One row: something measured at one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Line of the file.
    pub line: usize,
    /// Encoder readings, rad or m.
    pub q: Vec<f64>,
    /// What it measured.
    pub kind: KindId,
    /// What the columns of its kind say, SI: of a point its coordinates in the
    /// tracker frame, m.
    pub measured: Values,
    /// Standard deviation of a component that is a length, m.
    pub sigma: f64,
    /// The same of an angle, rad.
    pub sigma_angle: f64,
    /// The same of a place in an image, px.
    pub sigma_px: f64,
    /// What it refers to beside the arm, indices into
    /// [`Measurements::instruments`], in the order that its kind gives them.
    pub refers: Vec<usize>,
    /// The row of the other end, of a kind that joins two.
    pub partner: Option<usize>,
    /// Index into [`Measurements::stations`].
    pub station: usize,
    /// Index into [`Measurements::markers`].
    pub marker: usize,
    /// Number of the pose; rows with the same joints share it.
    pub pose: usize,
    /// Label of the series.
    pub series: Option<String>,
    /// Seconds since the session's start.
    pub time: Option<f64>,
    /// Degrees Celsius.
    pub temperature: Option<f64>,
    /// Where in its session of temperatures it is, if it has a time and a temperature.
    pub warming: Option<Warming>,
    /// kg
    pub payload: Option<f64>,
    /// Order of measurement.
    pub order: Option<f64>,
    /// Which run of the clock it is of: files and series whose times begin anew are others.
    pub run: u32,
    /// Orientation of the target in the tracker frame, quaternion x, y, z, w.
    pub orientation: Option<[f64; 4]>,
    /// Side from which each joint came to rest: +1, -1, or 0 if unknown.
    pub directions: Vec<i8>,
    /// What each joint was read to hold the arm with, N m or N, positive in +q;
    /// empty where nothing reads it.
    pub torques: Vec<f64>,
}

impl Row {
    /// At joint values of which nothing else is known.
    #[must_use]
    pub fn at(q: Vec<f64>) -> Self {
        Self {
            line: 0,
            q,
            kind: KindId::default(),
            measured: Values::default(),
            sigma: 0.0,
            station: 0,
            marker: 0,
            pose: 0,
            series: None,
            time: None,
            temperature: None,
            warming: None,
            payload: None,
            order: None,
            run: 0,
            orientation: None,
            directions: Vec::new(),
            torques: Vec::new(),
            partner: None,
            refers: Vec::new(),
            sigma_angle: 0.0,
            sigma_px: 0.0,
        }
    }

    /// Becomes a point, known or not: of what measured more its first three numbers.
    pub fn make_point(&mut self) {
        self.measured = self.measured.point().into();
        self.kind = KindId::default();
        self.refers.clear();
        self.partner = None;
    }

    /// Joints and what was measured, bit by bit.
    #[must_use]
    pub fn bits(&self) -> Vec<u64> {
        self.q.iter().chain(self.measured.iter()).map(|v| v.to_bits()).collect()
    }

    /// Whether both say the same, on whatever line of the file.
    fn repeats(&self, other: &Self) -> bool {
        // Most differ in what was measured. The first of a file has no sides taken from order.
        let like = |other: &Self| Self {
            line: self.line,
            run: self.run,
            directions: self.directions.clone(),
            warming: self.warming.clone(),
            ..other.clone()
        };
        self.measured == other.measured && like(other) == *self
    }
}

impl Measurements {
    /// Rows that could be measured next, under the conditions of the first row,
    /// approached from either side; no point is known of them.
    #[must_use]
    pub fn trial(&self, poses: &[Vec<f64>], rng: &mut ChaCha8Rng) -> Self {
        let like = &self.rows[0];
        let rows = poses.iter().map(|q| {
            let directions =
                like.directions.iter().map(|_| if rng.random_bool(0.5) { 1 } else { -1 }).collect();
            Row { q: q.clone(), directions, ..like.clone() }
        });
        Self { rows: rows.collect(), ..self.clone() }
    }

    /// The same rows with all standard deviations so many times as large.
    #[must_use]
    pub fn with_noise(&self, scale: f64) -> Self {
        let mut out = self.clone();
        for row in &mut out.rows {
            row.sigma *= scale;
            row.sigma_angle *= scale;
            row.sigma_px *= scale;
        }
        out
    }

    /// The file of a row.
    #[must_use]
    pub fn file_of(&self, row: usize) -> &Path {
        let own = self.behind.iter().rev().find(|(_, first)| *first <= row);
        own.map_or(&self.path, |(path, _)| path)
    }

    /// All files, for a report.
    #[must_use]
    pub fn files(&self) -> String {
        let behind = self.behind.iter().map(|(path, _)| path);
        let all = std::iter::once(&self.path).chain(behind);
        all.map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
    }

    /// Whether every row says what the joints were read to hold.
    #[must_use]
    pub fn has_torques(&self) -> bool {
        self.rows.iter().all(|row| !row.torques.is_empty())
    }

    /// Rows of which no earlier one is the same in every cell that has a meaning:
    /// nothing is measured twice to the last digit.
    #[must_use]
    pub fn distinct(&self) -> Vec<usize> {
        let first = self.first_of_copies();
        (0..self.rows.len()).filter(|row| first[*row] == *row).collect()
    }

    /// Of every row the first one that is the same in every cell that has a meaning: itself,
    /// where no earlier one is.
    #[must_use]
    pub fn first_of_copies(&self) -> Vec<usize> {
        // The last new row of each pose, and the one before it of each new row.
        let mut last: HashMap<usize, usize> = HashMap::with_capacity(self.poses);
        let mut before: Vec<Option<usize>> = vec![None; self.rows.len()];
        let mut first = |row: usize| {
            let (own, mut next) = (&self.rows[row], last.get(&self.rows[row].pose).copied());
            while let Some(known) = next {
                if self.rows[known].repeats(own) {
                    return known;
                }
                next = before[known];
            }
            before[row] = last.insert(own.pose, row);
            row
        };
        (0..self.rows.len()).map(&mut first).collect()
    }

    /// How many rows of `other` are rows of these too: the same joints, the same
    /// measured values.
    #[must_use]
    pub fn shared(&self, other: &Self) -> usize {
        let own: std::collections::HashSet<Vec<u64>> = self.rows.iter().map(Row::bits).collect();
        other.rows.iter().filter(|row| own.contains(&row.bits())).count()
    }

    /// Smallest and largest value of each joint.
    #[must_use]
    pub fn covered(&self) -> Vec<[f64; 2]> {
        let first = &self.rows[0].q;
        let mut range: Vec<_> = first.iter().map(|q| [*q, *q]).collect();
        for row in &self.rows {
            for (range, q) in range.iter_mut().zip(&row.q) {
                *range = [range[0].min(*q), range[1].max(*q)];
            }
        }
        range
    }
}

/// What a controller was told and where the target then was: a file with
/// commanded joints (`cmd1_deg..`) or commanded points (`cmd_x_mm, cmd_y_mm,
/// cmd_z_mm`, in the robot's frame) beside the measured `x_mm, y_mm, z_mm` and
/// the optional columns of measurements.csv.
#[derive(Debug, Clone)]
pub struct Commanded {
    /// The rows; their `q` are the commanded joints, empty where points were
    /// commanded.
    pub data: Measurements,
    /// Commanded points, one a row, m; empty where joints were commanded.
    pub points: Vec<Vector3<f64>>,
}
