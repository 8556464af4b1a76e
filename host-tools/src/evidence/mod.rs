//! Evidence: which of many candidate effects the data hold, with
//! probabilities. Linear algebra only; it knows residuals, columns and priors,
//! and nothing of arms. Method, thresholds and the studies that set them:
//! `docs/evidence.md`.
//!
//! Rows go into a [`Gram`] once, whitened by [`poses`] and [`directed`] and weighted by
//! [`tails`]; [`explain`] does the rest from it.
//!
//! ```
//! use nalgebra::{DMatrix, DVector};
//! use truearm_host::evidence::{Candidate, Claim, Effort, Gram, explain, prior};
//!
//! // One unknown of geometry (a constant), two candidates (a slope, a square).
//! let x = DVector::from_fn(40, |i, _| i as f64 / 20.0 - 1.0);
//! let g = DMatrix::from_element(40, 1, 1.0);
//! let z = DMatrix::from_fn(40, 2, |i, j| x[i].powi(j as i32 + 1));
//! let y = x.map(|x| 3.0 + 2.0 * x + 0.2 * (90.0 * x).sin());
//! let mut gram = Gram::new(1, 2);
//! gram.add(&g, &z, &y);
//! let candidate = |name| Candidate {
//!     name,
//!     place: 0,
//!     part: 0,
//!     common: 0,
//!     units: vec![0],
//!     log_odds: prior::log_odds(1, 1),
//! };
//! let found =
//!     explain(&gram, &DVector::from_element(1, 1e-6), &[candidate(0), candidate(1)], Effort::default(), None);
//! assert!(found.posterior.probability(Claim { name: 0, place: 0 }) > 0.99);
//! assert!(found.posterior.probability(Claim { name: 1, place: 0 }) < 0.1);
//! assert!((found.coefficients[0][0].value - 2.0).abs() < 0.2);
//! ```

mod addition;
mod aliases;
mod candidate;
mod coefficients;
mod curve;
pub mod directed;
pub mod drawn;
mod exchange;
mod fixed_point;
mod geometry;
mod gram;
pub mod lines;
mod noise;
pub mod poses;
mod posterior;
pub mod prior;
mod projected;
mod search;
pub mod smooth;
mod subset;
pub mod tails;
#[cfg(test)]
mod tests;
mod triangular;

use nalgebra::DVector;

pub use aliases::Aliases;
pub use candidate::Candidate;
pub use coefficients::Coefficient;
pub use exchange::Exchange;
pub use geometry::Geometry;
pub use gram::Gram;
pub use noise::{NU, Noise};
pub use posterior::{Claim, Posterior};
pub use projected::Projected;
pub use search::{Effort, WINDOW};
pub use subset::{Subset, Subsets};

use fixed_point::fixed_point;
use search::Search;

/// Rounds of search and noise scale; the scale settles in two or three.
const ROUNDS: usize = 4;
/// Steps in which the scale of a model is found at most.
const MOST_STEPS: usize = 20;
/// Relative change of the noise scale that no longer matters.
const SETTLED: f64 = 0.02;

/// What the data hold.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// Noise scale k: the noise is this many times the stated sigma.
    pub scale: f64,
    /// The most probable model: its candidates, ascending.
    pub best: Subset,
    /// Coefficients of each of its candidates' columns.
    pub coefficients: Vec<Vec<Coefficient>>,
    /// Size of each of its effects beyond geometry, in noise floors.
    pub floors: Vec<f64>,
    /// All models.
    pub posterior: Posterior,
}

impl Explanation {
    /// Takes candidates out of the best model that something else speaks against.
    pub fn leave_out(&mut self, gone: impl Fn(usize) -> bool) {
        let members = &self.best.members;
        let kept: Vec<usize> = (0..members.len()).filter(|k| !gone(members[*k])).collect();
        pick(&mut self.best.members, &kept);
        pick(&mut self.best.sizes, &kept);
        pick(&mut self.coefficients, &kept);
        pick(&mut self.floors, &kept);
    }
}

impl Explanation {
    /// The same where the log mass of each model, of its members, changes: the most probable
    /// of them then.
    #[must_use]
    pub fn reweighed(
        self,
        gram: &Gram,
        precision: &DVector<f64>,
        candidates: &[Candidate],
        change: &dyn Fn(&[usize]) -> f64,
    ) -> Self {
        let models = self.posterior.models.iter();
        let masses = models.map(|(members, p)| (members.clone(), p.ln() + change(members)));
        let posterior = Posterior::new(&masses.collect(), candidates);
        let members = posterior.models.first().map_or(Vec::new(), |(m, _)| m.clone());
        if members == self.best.members {
            return Self { posterior, ..self };
        }
        let projected = gram.project(&gram.geometry(precision, self.scale));
        let subsets = Subsets::new(projected, candidates.to_vec());
        let best = subsets.fit(&members, &|_| None);
        Self {
            scale: subsets.scale_of(&best).max(1e-9 * self.scale),
            coefficients: subsets.coefficients(&best),
            floors: subsets.floors(&best),
            best,
            posterior,
        }
    }
}

/// Noise scale that a model leaves beside geometry, looked for from one.
fn scale_of_model(
    gram: &Gram,
    precision: &DVector<f64>,
    candidates: &[Candidate],
    members: &[usize],
    from: f64,
) -> f64 {
    let first = |m: usize| candidates[..m].iter().map(|c| c.units.len()).sum::<usize>();
    let columns_of = |m: &usize| first(*m)..first(*m) + candidates[*m].units.len();
    let columns: Vec<usize> = members.iter().flat_map(columns_of).collect();
    let own: Vec<Candidate> = members.iter().map(|m| candidates[*m].clone()).collect();
    let all: Vec<usize> = (0..own.len()).collect();
    fixed_point(from, SETTLED, MOST_STEPS, &mut |k| {
        let geometry = gram.geometry(precision, k);
        let projected = gram.project_some((&geometry, gram.noise(&geometry)), &columns);
        let subsets = Subsets::new(projected, own.clone());
        subsets.scale_of(&subsets.fit(&all, &|_| None)).max(1e-9 * k)
    })
}

fn pick<T: Clone>(of: &mut Vec<T>, kept: &[usize]) {
    *of = kept.iter().map(|k| of[*k].clone()).collect();
}

/// A model to begin with, beside nothing, and the noise scale that it left.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// Its candidates.
    pub members: Vec<usize>,
    /// Noise over the stated sigma.
    pub scale: f64,
}

/// Searches the subsets of `candidates`, whose columns stand in `gram` in turn;
/// `precision` is the diagonal of geometry's prior. Begins with nothing and what
/// is `known`. Found again at the noise scale that the best model leaves, until
/// it no longer changes: a missing effect counts as noise only as long as it is
/// missing.
#[must_use]
pub fn explain(
    gram: &Gram,
    precision: &DVector<f64>,
    candidates: &[Candidate],
    effort: Effort,
    known: Option<&Known>,
) -> Explanation {
    let geometry = || gram.scale_of_geometry(precision);
    let mut scale = known.map_or_else(geometry, |known| known.scale);
    let mut roots = vec![Vec::new()];
    roots.extend(known.map(|known| known.members.clone()));
    let mut round = 0;
    loop {
        let projected = gram.project(&gram.geometry(precision, scale));
        let subsets = Subsets::new(projected, candidates.to_vec());
        let mut search = Search::run(&subsets, effort, &roots);
        let posterior = Posterior::new(search.masses(), candidates);
        let members = posterior.models.first().map_or(Vec::new(), |(m, _)| m.clone());
        let best = search.fit(&members).clone();
        let found = subsets.scale_of(&best).max(1e-9 * scale);
        let change = (found / scale).ln().abs();
        let found = match change < SETTLED {
            true => found,
            false => scale_of_model(gram, precision, candidates, &members, found),
        };
        round += 1;
        if change < SETTLED || round == ROUNDS {
            return Explanation {
                scale: found,
                coefficients: subsets.coefficients(&best),
                floors: subsets.floors(&best),
                best,
                posterior,
            };
        }
        scale = found;
        // The search went everywhere; at another scale it goes on from there.
        roots = vec![members];
    }
}
