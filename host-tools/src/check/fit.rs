//! The short fit that a hypothesis is judged by: registration, then a few
//! Gauss-Newton steps with weights that withstand gross rows. The noise is an
//! unknown, so that neither a misstated sigma nor what the model lacks decides.

use nalgebra::{DMatrix, DVector, Vector3};
use truearm::Pose;

use super::chains::{Chains, PLAIN};
use super::scene::{Scene, Sight};
use crate::identify::{State, Unknown, Unknowns, rigid_transform};
use crate::model::arm::Derivatives;
use crate::statistics::{median, robust_distance_scale};

/// Nominal parameters are held within so many tolerances (1 mm, 1 mrad): arms
/// with three times the usual errors are sound.
pub(super) const TOLERANCES: f64 = 3.0;
/// No file is judged finer than this, m: gross mistakes are not of this size.
const FINEST: f64 = 5e-5;
/// Degrees of freedom of Student's t, by whose likelihood rows count.
const FREEDOM: f64 = 4.0;
/// No step turns anything by more, rad: beyond, the linearisation says nothing.
const LONGEST_TURN: f64 = 0.5;
/// Standard deviation of what is not held: base m and rad, tool m.
const LOOSE: [f64; 2] = [10.0, 1.0];
/// The same of a number that is fitted, m or rad.
const FITTED: f64 = 3.0;
/// Beyond so many scales a row is no part of the misfit.
const GROSS: f64 = 10.0;

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
            Self::Full => 15,
        }
    }
}

/// How well a hypothesis fits.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    /// The arm.
    pub state: State,
    /// Robust standard deviation of a coordinate, m.
    pub spread: f64,
    /// Root mean square of the distances without gross rows, m.
    pub rms: f64,
    /// Root mean square distance of the points from their middle, m.
    pub extent: f64,
    /// Negative logarithm of the likelihood, nats a row.
    pub misfit: f64,
    /// Negative logarithm of the prior of the corrections, nats.
    pub prior: f64,
    /// Largest correction of a link that is held near nominal, tolerances.
    pub correction: f64,
}

/// Fits a scene.
pub(super) fn fit(
    scene: &Scene,
    stations: usize,
    markers: usize,
    sigma: f64,
    effort: Effort,
) -> Fitted {
    let unknowns = Unknowns::new(stations, markers, 0, scene.links.len());
    let free = free(scene, &unknowns, effort);
    let fitter = Fitter { scene, free, unknowns, sigma, extent: extent(&scene.sights) };
    let mut state = fitter.registered(stations, markers);
    let mut best = fitter.judged(&state);
    for _ in 0..effort.steps() {
        let Some(step) = fitter.step(&state) else { break };
        state = state.stepped(&fitter.unknowns, &step);
        let now = fitter.judged(&state);
        let gain = fitter.objective(&best) - fitter.objective(&now);
        if gain > 0.0 {
            best = now;
        }
        if gain.abs() < 0.01 {
            break;
        }
    }
    best
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

struct Fitter<'a> {
    scene: &'a Scene,
    unknowns: Unknowns,
    free: Vec<(usize, f64)>,
    sigma: f64,
    extent: f64,
}

impl Fitter<'_> {
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
    fn step(&self, state: &State) -> Option<DVector<f64>> {
        let (mut normal, mut right) = self.equations(state);
        for (at, ((_, sd), x)) in self.free.iter().zip(&self.held(state)).enumerate() {
            normal[(at, at)] += sd.powi(-2);
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
        let at = |s: &Sight| chains.of(s.station, s.marker).derivatives(&s.q, &[], &PLAIN);
        let moved: Vec<Derivatives> = sights.iter().map(at).collect();
        let residuals: Vec<Vector3<f64>> =
            sights.iter().zip(&moved).map(|(s, d)| s.point - d.point).collect();
        let far: Vec<f64> = residuals.iter().map(Vector3::norm).collect();
        let spread = self.spread(&far);
        let count = self.free.len();
        let (mut normal, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
        let mut columns: Vec<(usize, Vector3<f64>)> = Vec::with_capacity(count);
        for (((sight, d), r), far) in sights.iter().zip(&moved).zip(&residuals).zip(&far) {
            columns.clear();
            columns.extend(self.free.iter().enumerate().filter_map(|(at, (k, _))| {
                Some((at, column(self.unknowns.list()[*k], sight, d)?))
            }));
            let weight = (FREEDOM + 3.0) / (FREEDOM + (far / spread).powi(2)) / spread.powi(2);
            for (i, (row, a)) in columns.iter().enumerate() {
                let a = a * weight;
                right[*row] += a.dot(r);
                for (column, b) in &columns[..=i] {
                    normal[(*row, *column)] += a.dot(b);
                }
            }
        }
        (normal, right)
    }

    /// How far free unknowns are from where they are held: links from nominal,
    /// tools from the stated one; a base from nowhere.
    fn held(&self, state: &State) -> Vec<f64> {
        let (stations, link) = (state.bases.len(), self.unknowns.free());
        let of = |(k, _): &(usize, f64)| match *k {
            k if k >= link => {
                let (i, p) = ((k - link) / 5, (k - link) % 5);
                let (now, then) = (&state.links[i].parameters, &self.scene.links[i].parameters);
                now.to_array()[p] - then.to_array()[p]
            }
            k if k >= 6 * stations => {
                let m = k - 6 * stations;
                state.markers[m / 3][m % 3] - self.scene.tool[m % 3]
            }
            _ => 0.0,
        };
        self.free.iter().map(of).collect()
    }

    fn spread(&self, far: &[f64]) -> f64 {
        robust_distance_scale(far).max(self.sigma).max(FINEST)
    }

    fn judged(&self, state: &State) -> Fitted {
        let chains = Chains::new(state);
        let miss =
            |s: &Sight| (s.point - chains.of(s.station, s.marker).pose(&s.q).translation).norm();
        let far: Vec<f64> = self.scene.sights.iter().map(miss).collect();
        let spread = self.spread(&far);
        let row = |d: &f64| {
            let tail = (1.0 + (d / spread).powi(2) / FREEDOM).ln() * (FREEDOM + 3.0) / 2.0;
            // In the file's own numbers: a smaller unit makes no better fit.
            tail + 3.0 * (spread / self.scene.scale).ln()
        };
        let misfit = far.iter().map(row).sum::<f64>() / far.len().max(1) as f64;
        let held = self.held(state);
        let near = far.iter().copied().filter(|d| *d <= GROSS * spread);
        let (squares, count) = near.fold((0.0, 0.0), |(sum, n), d| (sum + d * d, n + 1.0));
        let of = |((k, _), x): (&(usize, f64), &f64)| match self.unknowns.list()[*k] {
            Unknown::Link(joint, p) if self.scene.fitted.contains(&(joint, p)) => 0.0,
            link @ Unknown::Link(..) => x.abs() / link.tolerance(),
            _ => 0.0,
        };
        Fitted {
            state: state.clone(),
            spread,
            extent: self.extent,
            rms: (squares / f64::max(count, 1.0)).sqrt(),
            misfit: if misfit.is_finite() { misfit } else { f64::INFINITY },
            prior: self.free.iter().zip(&held).map(|((_, sd), x)| (x / sd).powi(2) / 2.0).sum(),
            correction: self.free.iter().zip(&held).map(of).fold(0.0, f64::max),
        }
    }

    /// What a fit lowers.
    fn objective(&self, fitted: &Fitted) -> f64 {
        fitted.misfit * self.scene.sights.len() as f64 + fitted.prior
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
