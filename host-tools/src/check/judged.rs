//! How well a state of the arm fits: what a fit lowers, and what is told of it.

use super::chains::Chains;
use super::scene::{Scene, Sight};
use crate::identify::{State, Unknown, Unknowns};
use crate::statistics::robust_distance_scale;

/// No file is judged finer than this, m: gross mistakes are not of this size.
const FINEST: f64 = 5e-5;
/// Rows agree to the last digit, as a share of how far points lie apart.
const NOTHING: f64 = 1e-6;
/// Fits as good as each other end within this ratio of how far off rows are.
const SEEN: f64 = 1.25;
/// Beyond so many scales a row is no part of the misfit.
pub(super) const GROSS: f64 = 10.0;

/// Degrees of freedom of Student's t, by whose likelihood rows count.
pub(super) const FREEDOM: f64 = 4.0;
/// How well a hypothesis fits.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    /// The arm.
    pub state: State,
    /// Robust standard deviation of a coordinate, m.
    pub spread: f64,
    /// The same as rows have it, in the file's own numbers.
    pub robust: f64,
    /// Least standard deviation that is stated of a coordinate, m.
    pub sigma: f64,
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
    /// How far every row is off, m.
    pub far: Vec<f64>,
}

impl Fitted {
    /// Whether rows are as near as anything is judged.
    pub(super) fn is_finest(&self) -> bool {
        self.spread <= self.sigma.max(FINEST)
    }

    /// Nats by which another is better as far as rows tell it and not the floor of what is
    /// judged, which is not of the same size in every unit.
    pub(super) fn worse_than(&self, other: &Self) -> f64 {
        let ratio = self.robust / other.robust;
        let rows = if (1.0 / SEEN..SEEN).contains(&ratio) { 0.0 } else { ratio.ln() };
        3.0 * self.far.len() as f64 * rows + self.prior - other.prior
    }
}

/// A scene being fitted.
pub(super) struct Fitter<'a> {
    pub(super) scene: &'a Scene,
    pub(super) unknowns: Unknowns,
    pub(super) free: Vec<(usize, f64)>,
    pub(super) sigma: f64,
    /// How many times finer than usual rows are judged.
    pub(super) finer: f64,
    pub(super) extent: f64,
}

impl Fitter<'_> {
    /// How far free unknowns are from where they are held: links from nominal,
    /// tools from the stated one; a base from nowhere.
    pub(super) fn held(&self, state: &State) -> Vec<f64> {
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

    pub(super) fn spread(&self, far: &[f64]) -> f64 {
        robust_distance_scale(far).max(self.sigma.max(FINEST) / self.finer)
    }

    pub(super) fn judged(&self, state: &State) -> Fitted {
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
            sigma: self.sigma,
            robust: robust_distance_scale(&far).max(NOTHING * self.extent) / self.scene.scale,
            extent: self.extent,
            rms: (squares / f64::max(count, 1.0)).sqrt(),
            misfit: if misfit.is_finite() { misfit } else { f64::INFINITY },
            prior: self.free.iter().zip(&held).map(|((_, sd), x)| (x / sd).powi(2) / 2.0).sum(),
            correction: self.free.iter().zip(&held).map(of).fold(0.0, f64::max),
            far,
        }
    }

    /// What a fit lowers.
    pub(super) fn objective(&self, fitted: &Fitted) -> f64 {
        fitted.misfit * self.scene.sights.len() as f64 + fitted.prior
    }

    /// What a step lowers: the misfit of the rows at a scale, and the prior, nats.
    pub(super) fn at_scale(&self, fitted: &Fitted, spread: f64) -> f64 {
        let tail = |d: &f64| (1.0 + (d / spread).powi(2) / FREEDOM).ln() * (FREEDOM + 3.0) / 2.0;
        fitted.far.iter().map(tail).sum::<f64>() + fitted.prior
    }
}
