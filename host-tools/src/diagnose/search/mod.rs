//! Which terms to add: several explanations are followed side by side, because
//! one missing effect makes many others look significant. Each is fitted
//! jointly with the geometry, flags and all, and they are compared by what they
//! explain less a price for every coefficient and every alternative tried.

mod limit;
pub mod node;
mod rounds;
mod scan;
pub mod score;

use nalgebra::DVector;

use super::candidates::Candidate;
use super::policy::POLICY;
use crate::error::Result;
use crate::identify::robust::{Flags, RobustFit, refit, robust_fit};
use crate::identify::{Problem, State};
use crate::model::ModelTerm;
use crate::tikhonov::{Factorised, covariance};
use node::Node;
use scan::scan;
use score::{Score, Scorer};

/// Families an effect may come from.
pub const FAMILIES: f64 = crate::effects::ALL.len() as f64;

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
    /// Most terms of the arm that the model may have.
    pub most_terms: usize,
}

/// Price of so many coefficients chosen among so many alternatives.
fn price(freedom: usize, tried: f64, equations: usize) -> f64 {
    freedom as f64 * (equations as f64).ln() + 2.0 * tried.ln() + 2.0 * FAMILIES.ln()
}

impl Search<'_> {
    /// Fits an explanation from a state that has some of its terms.
    ///
    /// # Errors
    /// When the fit does not converge.
    pub fn fit(&self, added: Vec<Candidate>, start: &State) -> Result<Node> {
        self.fit_near(added, start, None)
    }

    /// Fits an explanation near another one, whose flags are the first guess.
    pub(super) fn fit_near(
        &self,
        added: Vec<Candidate>,
        start: &State,
        flagged: Option<&RobustFit>,
    ) -> Result<Node> {
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
        let fit = match flagged {
            None => robust_fit(&problem, self.rows, &start, self.flags)?,
            Some(near) => {
                let flagged = near.outliers.iter().map(|o| o.row).collect();
                refit(&problem, self.rows, &start, flagged, self.flags)?
            }
        };
        let at = problem.linearise(&fit.fit.state);
        let square: f64 = fit.kept.iter().map(|r| at.scaled_residual(*r).norm_squared()).sum();
        let (rows, equations) = (self.rows.len() as f64, self.problem.equations(self.rows));
        let flags: f64 =
            fit.outliers.iter().map(|o| price(o.residual.len(), rows, equations)).sum();
        let terms: f64 = added.iter().map(|c| price(c.terms.len(), c.tried, equations)).sum();
        let prior = self.flags.lambda * problem.corrections(&fit.fit.state).norm_squared();
        let unknowns = problem.unknowns.free() as f64 + self.determined(&problem, &fit);
        let freedom = (problem.equations(&fit.kept) as f64 - unknowns).max(1.0);
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
        let f = Factorised::of_normal(&fit.fit.normal, problem.unknowns.free());
        f.singular_values().iter().map(|s| s * s / (s * s + self.flags.lambda)).sum()
    }

    /// The most promising additions to a node, best first, at most a few of one
    /// effect.
    #[must_use]
    pub fn promising(&self, node: &Node, most: usize) -> Vec<(Candidate, Score, f64)> {
        let state = &node.fit.fit.state;
        let problem = self.problem.with_terms(state.terms.len());
        let fit = &node.fit;
        let Some(scorer) = Scorer::new(&problem, &fit.fit, &fit.kept, self.flags.lambda) else {
            return Vec::new();
        };
        let equations = self.problem.equations(self.rows);
        let rows = self.rows.len();
        let mut scored: Vec<(Candidate, Score, f64)> = Vec::new();
        let mut add = |candidate: Candidate, score: Score| {
            if score.freedom == 0 || node.added.iter().any(|a| a.excludes(&candidate)) {
                return;
            }
            // Where structure is left over, it counts as noise.
            let noise = (node.reduced - score.statistic / node.freedom).max(1.0);
            let gain =
                score.statistic / noise - price(candidate.terms.len(), candidate.tried, equations);
            scored.push((candidate, score, gain));
        };
        for (candidate, score) in self.candidates.iter().zip(scorer.test(self.candidates)) {
            add(candidate.clone(), score);
        }
        for (candidate, score) in scan(&scorer, self.highest_order) {
            add(candidate, score);
        }
        scored.sort_by(|a, b| b.2.total_cmp(&a.2));
        let mut out: Vec<(Candidate, Score, f64)> = Vec::new();
        for entry in scored {
            let place = out.iter().any(|o| o.0.excludes(&entry.0));
            let name = out.iter().filter(|o| o.0.name() == entry.0.name()).count();
            // Look-alikes of other families must get a turn.
            if !place
                && (name < POLICY.of_one_effect || rows >= POLICY.many_rows)
                && out.len() < most
            {
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
        if self.rows.len() >= POLICY.many_rows {
            return self.rounds(root, progress);
        }
        let mut all = vec![root];
        let mut beam = vec![0];
        for _ in 0..POLICY.deepest {
            let mut grown: Vec<Node> = Vec::new();
            for parent in &beam {
                let parent = all[*parent].clone();
                for (candidate, _, gain) in self.promising(&parent, POLICY.branches) {
                    if gain < POLICY.hint {
                        break;
                    }
                    let mut added = parent.added.clone();
                    added.push(candidate);
                    let known = |n: &Node| same_set(&n.added, &added);
                    if all.iter().any(known) || grown.iter().any(known) {
                        continue;
                    }
                    if let Ok(node) = self.fit_near(added, &parent.fit.fit.state, Some(&parent.fit))
                        && node.worth(&parent) > POLICY.worth
                        && node.plausible()
                    {
                        grown.push(node);
                    }
                    progress();
                }
            }
            if grown.is_empty() {
                break;
            }
            grown.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
            grown.truncate(2 * POLICY.beam);
            let first = all.len();
            all.extend(grown);
            beam = (first..all.len().min(first + POLICY.beam)).collect();
        }
        all.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        let best = self.pruned(all[0].clone())?;
        all.insert(0, best);
        Ok(all)
    }

    /// Drops every term that later ones made needless.
    fn pruned(&self, mut node: Node) -> Result<Node> {
        let equations = self.problem.equations(self.rows);
        let mut k = 0;
        while k < node.added.len() {
            // A refit only where it could end in dropping the term.
            if self.wald(&node, k)
                > POLICY.surely_kept
                    * price(node.added[k].terms.len(), node.added[k].tried, equations)
            {
                k += 1;
                continue;
            }
            let mut added = node.added.clone();
            added.remove(k);
            match self.fit_near(added, &node.fit.fit.state, Some(&node.fit)) {
                Ok(without) if node.worth(&without) < POLICY.hint => {
                    node = without;
                    k = 0;
                }
                _ => k += 1,
            }
        }
        Ok(node)
    }

    /// What dropping an addition would cost, from the covariance of its terms.
    pub(super) fn wald(&self, node: &Node, k: usize) -> f64 {
        let state = &node.fit.fit.state;
        let problem = self.problem.with_terms(state.terms.len());
        let cov = covariance(&node.fit.fit.normal, problem.unknowns.free(), self.flags.lambda);
        let before: usize = node.added[..k].iter().map(|c| c.terms.len()).sum();
        let (first, count) = (problem.unknowns.terms().start + before, node.added[k].terms.len());
        let unit = problem.unit(problem.unknowns.list()[first]);
        let c = DVector::from_fn(count, |i, _| state.terms[before + i].coefficient() / unit);
        let block = cov.view((first, first), (count, count)).into_owned();
        let solved = block.try_inverse().map(|inverse| (c.transpose() * inverse * &c)[0]);
        solved.unwrap_or(0.0) / node.reduced.max(1.0)
    }
}

fn same_set(a: &[Candidate], b: &[Candidate]) -> bool {
    a.len() == b.len() && a.iter().all(|x| b.iter().any(|y| x == y))
}
