//! The short fit that a hypothesis is judged by: registration, then a few
//! Gauss-Newton steps with weights that withstand gross rows. The noise is an
//! unknown, so that neither a misstated sigma nor what the model lacks decides.

use nalgebra::{DMatrix, DVector, Vector3};
use truearm::Pose;

use super::chains::Chains;
pub(super) use super::judged::Fitted;
use super::judged::{FREEDOM, Fitter};
use super::scene::{Scene, Sight};
use crate::identify::{State, Unknown, Unknowns, rigid_transform};
use crate::model::arm::{Derivatives, RowInputs};
use crate::statistics::median;

/// Nominal parameters are held within so many tolerances (1 mm, 1 mrad): arms
/// with three times the usual errors are sound.
pub(super) const TOLERANCES: f64 = 3.0;
/// No step turns anything by more, rad: beyond, the linearisation says nothing.
const LONGEST_TURN: f64 = 0.5;
/// Standard deviation of what is not held: base m and rad, tool m.
const LOOSE: [f64; 2] = [10.0, 1.0];
/// The same of a number that is fitted, m or rad.
const FITTED: f64 = 3.0;
/// Where a full step raises what is minimised, so much of the diagonal is added
/// first, and ten times as much each time it still does: what the data hardly
/// hold (a slide along parallel axes) would else run off by metres.
const DAMPED: f64 = 1e-3;
/// Gains below are none, nats.
const AT_REST: f64 = 0.01;

/// What is fitted, and how long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    /// Base, tool and the numbers that a hypothesis leaves open, in very few steps.
    Glance,
    /// The same in some more.
    Screen,
    /// All links as well, held near nominal, until it rests.
    Full,
}

impl Effort {
    fn steps(self) -> usize {
        match self {
            Self::Glance => 4,
            Self::Screen => 6,
            Self::Full => 60,
        }
    }
}

/// Fits a scene.
pub(super) fn fit(
    scene: &Scene,
    stations: usize,
    markers: usize,
    sigma: f64,
    effort: Effort,
) -> Fitted {
    let fitter = Fitter::new(scene, stations, markers, sigma, effort);
    let start = fitter.registered(stations, markers);
    fitter.fitted(&start, effort)
}

/// Fits a scene in full, base and tool starting from where another fit left them.
pub(super) fn fit_from(scene: &Scene, other: &State, sigma: f64) -> Fitted {
    finer_from(scene, other, sigma, 1.0)
}

/// The same, so many times finer than rows are judged.
pub(super) fn finer_from(scene: &Scene, other: &State, sigma: f64, finer: f64) -> Fitted {
    let (stations, markers) = (other.bases.len(), other.markers.len());
    let fitter = Fitter { finer, ..Fitter::new(scene, stations, markers, sigma, Effort::Full) };
    let start = State { links: scene.links.clone(), ..other.clone() };
    fitter.fitted(&start, Effort::Full)
}

/// Root mean square distance of points from their middle, m.
fn extent(sights: &[Sight]) -> f64 {
    let count = sights.len().max(1) as f64;
    let middle = sights.iter().map(|s| s.point).sum::<Vector3<f64>>() / count;
    (sights.iter().map(|s| (s.point - middle).norm_squared()).sum::<f64>() / count).sqrt()
}

/// Unknowns that move: index, standard deviation about where they are held.
fn free(scene: &Scene, unknowns: &Unknowns, effort: Effort) -> Vec<(usize, f64)> {
    let of = |(k, unknown): (usize, &Unknown)| match *unknown {
        Unknown::Station(..) => Some((k, LOOSE[0])),
        Unknown::Marker(..) => Some((k, LOOSE[1])),
        Unknown::Link(joint, p) if scene.fitted.contains(&(joint, p)) => Some((k, FITTED)),
        Unknown::Link(..) if effort == Effort::Full => Some((k, TOLERANCES * unknown.tolerance())),
        _ => None,
    };
    unknowns.list().iter().enumerate().filter_map(of).collect()
}

impl<'a> Fitter<'a> {
    fn new(scene: &'a Scene, stations: usize, markers: usize, sigma: f64, effort: Effort) -> Self {
        let unknowns = Unknowns::new(stations, markers, 0, scene.links.len());
        let free = free(scene, &unknowns, effort);
        Self { scene, free, unknowns, sigma, finer: 1.0, extent: extent(&scene.sights) }
    }

    /// The best state met on the way. In full no step is taken that raises what it
    /// lowers, and it goes on until it rests; a screening takes every step.
    fn fitted(&self, start: &State, effort: Effort) -> Fitted {
        let mut now = self.judged(start);
        let mut best = now.clone();
        let mut damping = 0.0;
        for _ in 0..effort.steps() {
            let Some(step) = self.step(&now.state, damping) else { break };
            let next = self.judged(&now.state.stepped(&self.unknowns, &step));
            let (before, after) =
                (self.at_scale(&now, now.spread), self.at_scale(&next, now.spread));
            // Not a number is no descent either.
            let descends = after <= before + AT_REST;
            if effort == Effort::Full && !descends {
                if damping > 1e9 {
                    break;
                }
                damping = f64::max(10.0 * damping, DAMPED);
                continue;
            }
            let gain = self.objective(&best) - self.objective(&next);
            let resting = damping <= 1.0 && gain.abs() < AT_REST;
            damping = if damping <= DAMPED { 0.0 } else { damping / 10.0 };
            now = next;
            if gain > 0.0 {
                best = now.clone();
            }
            if resting {
                break;
            }
        }
        best
    }

    /// The tool as stated, each base by SVD; where points lie on a line, only
    /// its place.
    fn registered(&self, stations: usize, markers: usize) -> State {
        let bare = State {
            bases: vec![Pose::identity(); stations],
            markers: vec![self.scene.tool; markers],
            instruments: Vec::new(),
            links: self.scene.links.clone(),
            terms: Vec::new(),
        };
        let arm = bare.chain(0, 0);
        let mut state = bare.clone();
        for (station, base) in state.bases.iter_mut().enumerate() {
            let here = || self.scene.sights.iter().filter(|s| s.station == station);
            let from: Vec<_> = here().map(|s| arm.pose(&s.q).translation).collect();
            let to: Vec<_> = here().map(|s| s.point).collect();
            let mut weights = vec![1.0; from.len()];
            for _ in 0..3 {
                let Some(pose) = rigid_transform(&from, &to, &weights) else { break };
                let pairs = from.iter().zip(&to);
                let far: Vec<f64> =
                    pairs.map(|(a, b)| (pose.transform_point(a) - b).norm()).collect();
                let scale = median(&far).max(1e-9);
                weights = far.iter().map(|d| (1.0 + (d / (2.0 * scale)).powi(2)).recip()).collect();
                *base = pose;
            }
        }
        state
    }

    /// A step of all unknowns, SI; zero of those that are held.
    fn step(&self, state: &State, damping: f64) -> Option<DVector<f64>> {
        let (mut normal, mut right) = self.equations(state);
        for (at, ((_, sd), x)) in self.free.iter().zip(&self.held(state)).enumerate() {
            normal[(at, at)] = (normal[(at, at)] + sd.powi(-2)) * (1.0 + damping);
            right[at] -= x / sd.powi(2);
        }
        // Only the lower triangle is filled and read.
        let solved = normal.cholesky()?.solve(&right);
        let mut step = DVector::zeros(self.unknowns.list().len());
        let mut turn = 0.0_f64;
        for ((k, _), value) in self.free.iter().zip(solved.iter()) {
            step[*k] = *value;
            if !self.unknowns.list()[*k].is_length() {
                turn = turn.max(value.abs());
            }
        }
        step.iter().all(|x| x.is_finite()).then(|| step * (LONGEST_TURN / turn).min(1.0))
    }

    /// Weighted normal equations of the rows in the free unknowns, lower triangle.
    fn equations(&self, state: &State) -> (DMatrix<f64>, DVector<f64>) {
        let chains = Chains::new(state);
        let sights = &self.scene.sights;
        let at =
            |s: &Sight| chains.of(s.station, s.marker).derivatives(&s.q, &[], &RowInputs::RIGID);
        let moved: Vec<Derivatives> = sights.iter().map(at).collect();
        let residuals: Vec<Vector3<f64>> =
            sights.iter().zip(&moved).map(|(s, d)| s.point - d.point).collect();
        let far: Vec<f64> = residuals.iter().map(Vector3::norm).collect();
        let spread = self.spread(&far);
        // A row of the file is three of these, so that columns are of one piece.
        let mut columns = DMatrix::zeros(3 * sights.len(), self.free.len());
        let mut misses = DVector::zeros(3 * sights.len());
        for (row, ((sight, d), (r, far))) in
            sights.iter().zip(&moved).zip(residuals.iter().zip(&far)).enumerate()
        {
            let weight = (FREEDOM + 3.0) / (FREEDOM + (far / spread).powi(2)) / spread.powi(2);
            let root = weight.sqrt();
            misses.fixed_rows_mut::<3>(3 * row).copy_from(&(r * root));
            for (at, (k, _)) in self.free.iter().enumerate() {
                if let Some(moves) = column(self.unknowns.list()[*k], sight, d) {
                    columns.fixed_view_mut::<3, 1>(3 * row, at).copy_from(&(moves * root));
                }
            }
        }
        let right = columns.tr_mul(&misses);
        let mut normal = DMatrix::zeros(self.free.len(), self.free.len());
        for column in 0..self.free.len() {
            for row in column..self.free.len() {
                normal[(row, column)] = columns.column(row).dot(&columns.column(column));
            }
        }
        (normal, right)
    }
}

/// How a seen point moves with an unknown; `None` if it does not.
fn column(unknown: Unknown, sight: &Sight, d: &Derivatives) -> Option<Vector3<f64>> {
    match unknown {
        Unknown::Station(s, k) => (s == sight.station).then(|| d.base[k]),
        Unknown::Marker(m, k) => (m == sight.marker).then(|| d.tool[k]),
        Unknown::Link(joint, parameter) => Some(*d.links[joint].get(parameter)),
        Unknown::Term(_) | Unknown::Instrument(..) => None,
    }
}
