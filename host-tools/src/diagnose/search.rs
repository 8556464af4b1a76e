//! Which terms to add: several explanations are followed side by side, because
//! one missing effect makes many others look significant. Each is fitted
//! jointly with the geometry, flags and all, and they are compared by what they
//! explain less a price for every coefficient and every alternative tried.

use nalgebra::Vector3;
use rayon::prelude::*;
use truearm::effects::Effect;

use super::candidates::Candidate;
use super::scan::scan;
use super::score::{Score, Scorer};
use crate::error::Result;
use crate::identify::robust::{Flags, RobustFit, robust_fit};
use crate::identify::{ModelTerm, Problem, State};

/// How wide and deep a search goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Explanations followed side by side.
    pub beam: usize,
    /// Refits tried from each.
    pub branches: usize,
    /// Most additions to one model.
    pub deepest: usize,
}

impl Effort {
    /// Few rows: look-alikes abound, so several explanations are followed. Many
    /// rows tell them apart at once, but show finer structure.
    #[must_use]
    pub fn for_rows(rows: usize) -> Self {
        if rows < 400 {
            Self { beam: 5, branches: 7, deepest: 6 }
        } else {
            Self { beam: 1, branches: 2, deepest: 32 }
        }
    }
}

/// What an addition must be worth beyond its price, in units of chi-square.
pub const WORTH: f64 = 8.0;
/// Families an effect may come from.
pub const FAMILIES: f64 = 11.0;

/// A fitted explanation.
#[derive(Debug, Clone)]
pub struct Node {
    /// What was added, in order.
    pub added: Vec<Candidate>,
    /// The fit.
    pub fit: RobustFit,
    /// Weighted sum of squares of the kept rows and penalty of the prior.
    pub misfit: f64,
    /// Price of terms and flags.
    pub price: f64,
    /// Weighted sum of squares of the kept rows over degrees of freedom.
    pub reduced: f64,
    /// Degrees of freedom.
    pub freedom: f64,
}

impl Node {
    /// What this explains beyond a node with fewer terms, less the price of the
    /// difference; structure that is left counts as noise.
    #[must_use]
    pub fn worth(&self, fewer: &Self) -> f64 {
        (fewer.misfit - self.misfit) / self.reduced.max(1.0) - (self.price - fewer.price)
    }

    /// The lower the better, for comparing explanations.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.misfit + self.price
    }

    /// Signs and sizes that the physics allows: compliance and growth give way,
    /// play lags behind.
    #[must_use]
    pub fn plausible(&self) -> bool {
        self.fit.fit.state.terms.iter().all(|t| {
            let c = t.coefficient();
            match t {
                ModelTerm::Arm(term) => match term.effect {
                    Effect::JointCompliance | Effect::BaseCompliance => (-1e-6..1e-2).contains(&c),
                    Effect::ThermalExpansion => (-1e-5..2e-4).contains(&c),
                    Effect::Backlash => c < 1e-5,
                    Effect::EncoderEccentricity => c.abs() < 6e-3,
                    _ => c.abs() < 2e-2,
                },
                _ => true,
            }
        })
    }
}

/// Everything a search needs.
pub struct Search<'a> {
    /// Geometry only.
    pub problem: &'a Problem<'a>,
    /// Candidates of known form.
    pub candidates: &'a [Candidate],
    /// Highest order to scan, cycles a turn.
    pub highest_order: f64,
    /// Lambda and flags.
    pub flags: Flags,
    /// Rows to fit.
    pub rows: &'a [usize],
    /// How wide and deep to go.
    pub effort: Effort,
}

/// Price of so many coefficients chosen among so many alternatives.
fn price(freedom: usize, tried: f64, rows: usize) -> f64 {
    freedom as f64 * (3.0 * rows as f64).ln() + 2.0 * tried.ln() + 2.0 * FAMILIES.ln()
}

impl Search<'_> {
    /// Fits an explanation from a state that has some of its terms.
    ///
    /// # Errors
    /// When the fit does not converge.
    pub fn fit(&self, added: Vec<Candidate>, start: &State) -> Result<Node> {
        let terms: Vec<ModelTerm> = added.iter().flat_map(|c| c.terms.iter().cloned()).collect();
        let problem = self.problem.with_terms(terms.len());
        let mut start = start.clone();
        let known = start.terms.clone();
        start.terms = terms;
        for term in &mut start.terms {
            let zero = |t: &ModelTerm| {
                let mut t = t.clone();
                *t.coefficient_mut() = 0.0;
                t
            };
            if let Some(old) = known.iter().find(|old| zero(old) == zero(term)) {
                *term = old.clone();
            }
        }
        let fit = robust_fit(&problem, self.rows, &start, self.flags)?;
        let at = problem.linearise(&fit.fit.state);
        let square: f64 = fit
            .kept
            .iter()
            .map(|r| at.residual(*r).norm_squared() / self.problem.data.rows[*r].sigma.powi(2))
            .sum();
        let n = self.rows.len();
        let flags = fit.outliers.len() as f64 * price(3, n as f64, n);
        let terms: f64 = added.iter().map(|c| price(c.terms.len(), c.tried, n)).sum();
        let prior = self.flags.lambda * problem.corrections(&fit.fit.state).norm_squared();
        let unknowns = problem.unknowns.free() as f64 + self.determined(&problem, &fit);
        let freedom = (3.0 * fit.kept.len() as f64 - unknowns).max(1.0);
        Ok(Node {
            added,
            misfit: square + prior,
            price: flags + terms,
            reduced: square / freedom,
            freedom,
            fit,
        })
    }

    /// Link parameters that the data and not the prior decide.
    fn determined(&self, problem: &Problem, fit: &RobustFit) -> f64 {
        let f = crate::tikhonov::Factorised::new(&fit.fit.triangle, problem.unknowns.free());
        f.singular_values().iter().map(|s| s * s / (s * s + self.flags.lambda)).sum()
    }

    /// The most promising additions to a node, best first, at most a few of one
    /// effect.
    #[must_use]
    pub fn promising(&self, node: &Node, most: usize) -> Vec<(Candidate, Score, f64)> {
        let state = &node.fit.fit.state;
        let problem = self.problem.with_terms(state.terms.len());
        let Some(scorer) = Scorer::new(&problem, state, &node.fit.kept, self.flags.lambda) else {
            return Vec::new();
        };
        let bases: Vec<Vector3<f64>> = state.bases.iter().map(|b| b.translation).collect();
        let rows = self.rows.len();
        let mut scored: Vec<(Candidate, Score, f64)> = Vec::new();
        let mut add = |candidate: Candidate, score: Score| {
            if score.freedom == 0 || node.added.iter().any(|a| a.excludes(&candidate)) {
                return;
            }
            // Where structure is left over, it counts as noise.
            let noise = (node.reduced - score.statistic / node.freedom).max(1.0);
            let gain =
                score.statistic / noise - price(candidate.terms.len(), candidate.tried, rows);
            scored.push((candidate, score, gain));
        };
        let tested = self.candidates.par_iter().map(|c| scorer.test(c, &bases));
        for (candidate, score) in self.candidates.iter().zip(tested.collect::<Vec<_>>()) {
            add(candidate.clone(), score);
        }
        for joint in 0..self.problem.nominal.len() {
            let joints = self.problem.nominal.len();
            for (candidate, score) in scan(&scorer.joint(joint), joint, joints, self.highest_order)
            {
                add(candidate, score);
            }
        }
        scored.sort_by(|a, b| b.2.total_cmp(&a.2));
        let mut out: Vec<(Candidate, Score, f64)> = Vec::new();
        for entry in scored {
            let place = out.iter().any(|o| o.0.excludes(&entry.0));
            let name = out.iter().filter(|o| o.0.name() == entry.0.name()).count();
            if !place && name < 3 && out.len() < most {
                out.push(entry);
            }
        }
        out
    }

    /// Follows the best explanations until none improves; all that were
    /// fitted, best first.
    ///
    /// # Errors
    /// When not even geometry alone can be fitted.
    pub fn run(&self, root: Node, progress: &dyn Fn()) -> Result<Vec<Node>> {
        let mut all = vec![root];
        let mut beam = vec![0];
        for _ in 0..self.effort.deepest {
            let mut grown: Vec<Node> = Vec::new();
            for parent in &beam {
                let parent = all[*parent].clone();
                for (candidate, _, gain) in self.promising(&parent, self.effort.branches) {
                    if gain < WORTH / 2.0 {
                        break;
                    }
                    let mut added = parent.added.clone();
                    added.push(candidate);
                    let known = |n: &Node| same_set(&n.added, &added);
                    if all.iter().any(known) || grown.iter().any(known) {
                        continue;
                    }
                    if let Ok(node) = self.fit(added, &parent.fit.fit.state) {
                        if node.worth(&parent) > WORTH && node.plausible() {
                            grown.push(node);
                        }
                    }
                    progress();
                }
            }
            if grown.is_empty() {
                break;
            }
            grown.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
            grown.truncate(2 * self.effort.beam);
            let first = all.len();
            all.extend(grown);
            beam = (first..all.len().min(first + self.effort.beam)).collect();
        }
        all.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        let best = self.pruned(all[0].clone())?;
        all.insert(0, best);
        Ok(all)
    }

    /// Drops every term that later ones made needless.
    fn pruned(&self, mut node: Node) -> Result<Node> {
        let mut k = 0;
        while k < node.added.len() {
            let mut added = node.added.clone();
            added.remove(k);
            match self.fit(added, &node.fit.fit.state) {
                Ok(without) if node.worth(&without) < WORTH / 2.0 => {
                    node = without;
                    k = 0;
                }
                _ => k += 1,
            }
        }
        Ok(node)
    }
}

fn same_set(a: &[Candidate], b: &[Candidate]) -> bool {
    a.len() == b.len() && a.iter().all(|x| b.iter().any(|y| x == y))
}
