//! Which mistake: every single one on few rows, the best of them on all, and
//! two at once where one does not say enough.

use nalgebra::Vector3;
use rayon::prelude::*;
use truearm::{Link, LinkParameter};

use super::fit::{Effort, Fitted, finer_from, fit, fit_from};
use super::hypotheses::{all, plain};
use super::mistake::{Convention, Mistake, New};
use super::sample::Sample;
use super::scene::Scene;

/// Rows on which all single mistakes are tried.
const ROWS_OF_ONE: usize = 40;
/// Rows on which all pairs are tried: there are ten thousand of them.
const ROWS_OF_TWO: usize = 12;
/// How many pairs are tried on more rows.
const PAIRS: usize = 240;
/// How many of the tried are fitted in full.
const FITTED_IN_FULL: usize = 24;
/// What a model lacks is alike in neighbouring rows: all rows of a file weigh
/// as this many independent ones do.
const INDEPENDENT_ROWS: f64 = 20.0;
/// Changes of a number by less are no gross mistakes, m or rad: 20 tolerances,
/// nearly seven standard deviations of a poorly made arm.
const GROSS_SIZE: f64 = 0.02;

/// An arm and its rows.
pub(super) struct Search<'a> {
    pub links: &'a [Link<f64>],
    pub tool: Vector3<f64>,
    pub sample: &'a Sample,
}

/// Mistakes and how well the rest fits without them.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub changes: Vec<Mistake>,
    pub fitted: Fitted,
    /// Negative logarithm of how probable it is, nats.
    pub cost: f64,
}

impl Search<'_> {
    /// Nothing changed.
    pub fn nothing(&self) -> Found {
        self.tried(Vec::new(), self.sample, Effort::Full)
    }

    /// Nothing changed, from where another explanation has base and tool: an
    /// explanation may not win because its fit began at a better place.
    pub fn nothing_from(&self, other: &Found) -> Found {
        let scene = Scene::new(self.links, self.tool, self.sample, &[]);
        let fitted = fit_from(&scene, &other.fitted.state, self.sample.sigma);
        Found { changes: Vec::new(), cost: self.cost(self.sample, &fitted), fitted }
    }

    /// By how many nats nothing changed is worse than another unit of the points, both fitted
    /// as finely in the file's own numbers: the floor of what is judged is of one length, and a
    /// fit that goes on below it is no better unit.
    pub fn worse_by(&self, nothing: &Found, unit: &Found) -> f64 {
        let scene = Scene::new(self.links, self.tool, self.sample, &[]);
        let finer = unit.fitted.extent / nothing.fitted.extent;
        let fitted = finer_from(&scene, &nothing.fitted.state, self.sample.sigma, finer);
        fitted.worse_than(&unit.fitted)
    }

    /// Negative logarithm of how probable a fit is, nats, whatever was changed.
    fn cost(&self, rows: &Sample, fitted: &Fitted) -> f64 {
        INDEPENDENT_ROWS.min(rows.rows.len() as f64) * fitted.misfit + fitted.prior
    }

    /// Single mistakes, the most probable first.
    pub fn one(&self) -> Vec<Found> {
        let few = self.sample.thinned(ROWS_OF_ONE);
        let tried: Vec<Vec<Mistake>> = all(self.links).into_iter().map(|c| vec![c]).collect();
        let mut full = best_of_each(self.screened(tried, &few, Effort::Screen), FITTED_IN_FULL);
        // A number that is off by a little only, a fit finds from where it is.
        full.extend(self.numbers().map(|number| vec![number]));
        self.in_full(full)
    }

    /// Two mistakes, the most probable first. Either alone may lower the misfit
    /// hardly at all, so that all pairs are tried. `ones` are the single ones.
    pub fn two(&self, ones: &[Found]) -> Vec<Found> {
        let all = all(self.links);
        let mut pairs = Vec::new();
        for (k, first) in all.iter().enumerate() {
            let others = all[k + 1..].iter().filter(|second| !second.same_place(first));
            pairs.extend(others.map(|second| vec![first.clone(), second.clone()]));
        }
        let few = self.sample.thinned(ROWS_OF_TWO);
        let mut pairs = best_of_each(self.screened(pairs, &few, Effort::Glance), PAIRS);
        let more = self.sample.thinned(ROWS_OF_ONE);
        pairs = best_of_each(self.screened(pairs, &more, Effort::Screen), FITTED_IN_FULL);
        for one in ones.iter().take(3).map(|one| &one.changes) {
            let others = self.numbers().filter(|number| one.iter().all(|c| !c.same_place(number)));
            pairs.extend(others.map(|number| [one.as_slice(), &[number]].concat()));
        }
        self.in_full(pairs)
    }

    /// Every number of a link that is not nought by definition, about where it is.
    fn numbers(&self) -> impl Iterator<Item = Mistake> {
        let of = [LinkParameter::Alpha, LinkParameter::A, LinkParameter::Theta, LinkParameter::D];
        let joints = 0..self.links.len();
        joints.flat_map(move |j| of.map(|p| Mistake::Value(j, p, New::About(0.0))))
    }

    fn screened(&self, tried: Vec<Vec<Mistake>>, rows: &Sample, effort: Effort) -> Vec<Found> {
        let each = tried.into_par_iter().map(|changes| self.tried(changes, rows, effort));
        let mut found: Vec<Found> = each.collect();
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found
    }

    fn in_full(&self, tried: Vec<Vec<Mistake>>) -> Vec<Found> {
        let mut found: Vec<Found> = tried.into_par_iter().map(|c| self.plainest(c)).collect();
        found.retain(|found| self.gross(&found.changes));
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found
    }

    /// A fit, and the numbers that it found in place of their starts.
    fn tried(&self, changes: Vec<Mistake>, rows: &Sample, effort: Effort) -> Found {
        let scene = Scene::new(self.links, self.tool, rows, &changes);
        let fitted = fit(&scene, rows.stations, rows.markers, rows.sigma, effort);
        let step = |joint: usize, p: LinkParameter| {
            let at = |links: &[Link<f64>]| links[joint].parameters.to_array()[place(p)];
            at(&fitted.state.links) - at(&scene.links)
        };
        let moved = |change: Mistake| match change {
            Mistake::Value(joint, p, New::About(by)) => {
                let mut by = by + step(joint, p);
                if !p.is_length() {
                    by = (by + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
                        - std::f64::consts::PI;
                }
                Mistake::Value(joint, p, New::About(by))
            }
            Mistake::Convention(Convention::Shifted(alpha, a)) => {
                let a = a + step(self.links.len() - 1, LinkParameter::A);
                Mistake::Convention(Convention::Shifted(alpha, a))
            }
            other => other,
        };
        let changes: Vec<Mistake> = changes.into_iter().map(moved).collect();
        let price: f64 = changes.iter().map(Mistake::price).sum();
        Found { changes, cost: self.cost(rows, &fitted) + price, fitted }
    }

    /// The full fit of these mistakes, or of the same with a plain value in
    /// place of a fitted one, whichever is more probable.
    fn plainest(&self, changes: Vec<Mistake>) -> Found {
        let mut best = self.tried(changes, self.sample, Effort::Full);
        best.changes.iter_mut().for_each(Mistake::round);
        for k in 0..best.changes.len() {
            let Mistake::Value(joint, p, New::About(by)) = best.changes[k] else { continue };
            let others: Vec<Mistake> =
                best.changes.iter().filter(|c| **c != best.changes[k]).cloned().collect();
            let before = Scene::new(self.links, self.tool, self.sample, &others);
            let stated = before.links[joint].parameters.to_array()[place(p)];
            for plain in plain(joint, p, stated, by) {
                let mut changes = best.changes.clone();
                changes[k] = plain;
                let found = self.tried(changes, self.sample, Effort::Full);
                if found.cost < best.cost {
                    best = found;
                }
            }
        }
        best
    }

    /// Whether each of the changes is of a size that no arm is off by itself.
    fn gross(&self, changes: &[Mistake]) -> bool {
        changes.iter().all(|change| {
            let Mistake::Value(joint, p, _) = change else { return true };
            let others: Vec<Mistake> = changes.iter().filter(|c| *c != change).cloned().collect();
            let value = |changes: &[Mistake]| {
                let scene = Scene::new(self.links, self.tool, self.sample, changes);
                scene.links[*joint].parameters.to_array()[place(*p)]
            };
            (value(changes) - value(&others)).abs() >= GROSS_SIZE
        })
    }
}

/// Place of a parameter among a link's five.
fn place(parameter: LinkParameter) -> usize {
    LinkParameter::ALL.iter().position(|p| *p == parameter).unwrap_or_default()
}

/// The first so many, of every number only the best start.
fn best_of_each(found: Vec<Found>, most: usize) -> Vec<Vec<Mistake>> {
    let mut kept: Vec<Vec<Mistake>> = Vec::new();
    for found in found {
        if kept.len() == most {
            break;
        }
        let alike = |other: &Vec<Mistake>| {
            other.iter().zip(&found.changes).all(|(a, b)| match (a, b) {
                (Mistake::Value(i, p, New::About(_)), Mistake::Value(j, q, New::About(_))) => {
                    i == j && p == q
                }
                _ => a == b,
            })
        };
        if !kept.iter().any(alike) {
            kept.push(found.changes);
        }
    }
    kept
}
