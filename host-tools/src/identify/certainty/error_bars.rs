//! How well parameters and predicted points are known.

use nalgebra::{DMatrix, Matrix3, Matrix6xX, SMatrix, Vector3};
use schemars::JsonSchema;
use serde::Serialize;

use super::redundancy::correlated;
use super::unknowns::Covariances;
use crate::identify::State;
use crate::identify::fit::estimate::Estimate;
use crate::identify::problem::accumulate::{CHUNK, tree};
use crate::identify::problem::{Problem, Unknown};
use crate::identify::start::tool;

/// Half width of a 95 % interval, in standard deviations.
pub const FACTOR: f64 = 1.959_964;

/// Half widths of 95 % intervals of the predicted tool point at the fitted
/// poses, a coordinate at a time, mm. What is not known of error curves of joints, from
/// noise and from what a curve can be, is in all four.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct PointBars {
    /// Root mean square over poses and coordinates.
    pub rms_mm: f64,
    /// Largest.
    pub max_mm: f64,
    /// The same from noise alone, without the bias of the regularisation.
    pub noise_rms_mm: f64,
    /// Its largest.
    pub noise_max_mm: f64,
}

impl PointBars {
    /// With more that is not known of a coordinate: mean and largest variance, m^2.
    #[must_use]
    pub fn with(self, mean: f64, largest: f64) -> Self {
        let wider = |bar: f64, more: f64| bar.hypot(more.sqrt() * FACTOR * 1e3);
        Self {
            rms_mm: wider(self.rms_mm, mean),
            max_mm: wider(self.max_mm, largest),
            noise_rms_mm: wider(self.noise_rms_mm, mean),
            noise_max_mm: wider(self.noise_max_mm, largest),
        }
    }
}

/// A parameter with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ParameterBar {
    /// Such as `joint 2 theta`.
    pub name: String,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// Correction to the nominal value.
    pub correction: f64,
    /// Half width of the interval, bias included.
    pub half_width: f64,
    /// From noise alone. Far below `half_width` where the tolerance and not the
    /// data says what is known.
    pub noise_half_width: f64,
}

/// Block `uncertainty` of a report.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct Uncertainty {
    /// Share of intervals that hold the truth.
    pub confidence: f64,
    /// Of the predicted tool point.
    pub tool_point: PointBars,
    /// Of link parameters.
    pub parameters: Vec<ParameterBar>,
    /// Pairs of parameters that the data tell together rather than each, in
    /// words.
    pub correlations: Vec<String>,
}

/// Error bars of an estimate.
#[must_use]
pub fn uncertainty(problem: &Problem, found: &Estimate, of: &Covariances) -> Uncertainty {
    let at = problem.linearise(&found.fit.state);
    // Of the marker that stands for the tool: an inclinometer's own is anywhere.
    let kept = &found.robust.kept;
    let tool = tool::of(problem.data);
    let of_tool = |row: &usize| tool.is_none_or(|tool| problem.data.rows[*row].marker == tool);
    let rows: Vec<usize> = kept.iter().copied().filter(of_tool).collect();
    let rows = &if rows.is_empty() { kept.clone() } else { rows };
    let frameless = (0..problem.data.stations.len()).all(|s| problem.unknowns.station(s).is_none());
    let target = |row: usize| {
        let (point, mut block) = at.target(row);
        // Where no row says where a target is, the tool is that of robot.toml.
        let marker = problem.unknowns.marker(problem.data.rows[row].marker);
        if let (None, Some(first)) = (tool, marker) {
            block.columns_mut(first, 3).fill(0.0);
        }
        (point, block)
    };
    let frame = if frameless { Frame::of(&target, of.units.len(), rows) } else { None };
    let leaf = |rows: &[usize]| Bars::of(&target, of, frame.as_ref(), rows);
    let bars = tree(rows, CHUNK, &leaf, &Bars::join);
    let count = bars.count.max(1) as f64;
    let [noise_rms_mm, rms_mm] = bars.squares.map(|s| (s / count).sqrt() * FACTOR * 1e3);
    let [noise_max_mm, max_mm] = bars.largest.map(|m| m.sqrt() * FACTOR * 1e3);
    Uncertainty {
        confidence: 0.95,
        tool_point: PointBars { rms_mm, max_mm, noise_rms_mm, noise_max_mm },
        parameters: parameters(problem, &found.fit.state, of),
        correlations: correlated(problem, &of.total()),
    }
}

/// Where the target of a row is seen, m, and how it moves with each unknown in its unit.
type Target<'a> = dyn Fn(usize) -> (Vector3<f64>, DMatrix<f64>) + Sync + 'a;

/// Variances of the coordinates of predicted points, m^2: from noise alone, and with
/// the bias.
#[derive(Default)]
struct Bars {
    count: usize,
    squares: [f64; 2],
    largest: [f64; 2],
}

impl Bars {
    fn of(target: &Target, of: &Covariances, frame: Option<&Frame>, rows: &[usize]) -> Self {
        let mut motions = DMatrix::zeros(of.units.len(), 3 * rows.len());
        for (i, row) in rows.iter().enumerate() {
            let (point, mut block) = target(*row);
            if let Some(frame) = frame {
                block -= frame.rigid(&point) * &frame.moved;
            }
            motions.columns_mut(3 * i, 3).copy_from(&block.transpose());
        }
        let [noise, bias] = [&of.noise, &of.bias].map(|covariance| covariance * &motions);
        let mut bars = Self { count: motions.ncols(), ..Self::default() };
        for (k, motion) in motions.column_iter().enumerate() {
            let [noise, bias] = [&noise, &bias].map(|c| motion.dot(&c.column(k)).max(0.0));
            for (k, variance) in [noise, noise + bias].into_iter().enumerate() {
                bars.squares[k] += variance;
                bars.largest[k] = bars.largest[k].max(variance);
            }
        }
        bars
    }

    fn join(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            squares: core::array::from_fn(|k| self.squares[k] + other.squares[k]),
            largest: core::array::from_fn(|k| self.largest[k].max(other.largest[k])),
        }
    }
}

/// How all points move as one body, to be taken out of their motions: where nothing is
/// known in the station's frame, where the arm stands is no error.
struct Frame {
    middle: Vector3<f64>,
    /// By each unknown, in its unit.
    moved: Matrix6xX<f64>,
}

impl Frame {
    /// `None` where the points do not say how a body turns.
    fn of(target: &Target, unknowns: usize, rows: &[usize]) -> Option<Self> {
        let points = |rows: &[usize]| rows.iter().map(|r| target(*r).0).sum::<Vector3<f64>>();
        let middle = tree(rows, CHUNK, &points, &|a, b| a + b) / rows.len().max(1) as f64;
        let mut frame = Self { middle, moved: Matrix6xX::zeros(unknowns) };
        let leaf = |rows: &[usize]| {
            let mut sums = (SMatrix::<f64, 6, 6>::zeros(), frame.moved.clone());
            for row in rows {
                let (point, block) = target(*row);
                let motion = frame.rigid(&point);
                sums.0 += motion.transpose() * motion;
                sums.1 += motion.transpose() * block;
            }
            sums
        };
        let (normal, pull) = tree(rows, CHUNK, &leaf, &|a, b| (a.0 + b.0, a.1 + b.1));
        frame.moved = normal.try_inverse()? * pull;
        Some(frame)
    }

    /// How a point of the body moves with its place and turn.
    fn rigid(&self, point: &Vector3<f64>) -> SMatrix<f64, 3, 6> {
        let mut motion = SMatrix::<f64, 3, 6>::zeros();
        motion.fixed_columns_mut::<3>(0).copy_from(&Matrix3::identity());
        motion.fixed_columns_mut::<3>(3).copy_from(&-(point - self.middle).cross_matrix());
        motion
    }
}

fn parameters(problem: &Problem, state: &State, of: &Covariances) -> Vec<ParameterBar> {
    let corrections = problem.corrections(state);
    let unknowns = problem.unknowns.list().iter().enumerate();
    let links = unknowns.filter(|(_, u)| matches!(u, Unknown::Link(..)));
    links
        .map(|(k, unknown)| {
            let (unit, of_si) =
                if unknown.is_length() { ("mm", 1e3) } else { ("deg", 1_f64.to_degrees()) };
            let factor = of_si * of.units[k];
            let noise = of.noise[(k, k)].max(0.0);
            let both = noise + of.bias[(k, k)].max(0.0);
            ParameterBar {
                name: unknown.name(problem.data),
                unit,
                correction: corrections[k] * factor + problem.expected(*unknown) * of_si,
                half_width: both.sqrt() * FACTOR * factor,
                noise_half_width: noise.sqrt() * FACTOR * factor,
            }
        })
        .collect()
}
