//! Which subsets of the candidates hold the probability: a deterministic
//! search. A beam climbs from nothing (and from known models), giving every
//! name a turn because one missing effect makes many others look significant;
//! then the best models are looked at once more from all sides, each member
//! taken out and everything else tried in its place, and of the best of all
//! pairs that hang together, with a new climb from there. Every model one addition
//! away from a model that was expanded is kept with its probability, so that
//! the sum over look-alikes is complete where it matters.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::subset::{Subset, Subsets};

/// How far and how long to look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Models followed side by side.
    pub beam: usize,
    /// Additions followed from each.
    pub branches: usize,
    /// Of them, at most so many of one name.
    pub of_a_name: usize,
    /// Most members of a model.
    pub members: usize,
    /// Members of the best models that are taken out and replaced.
    pub detours: usize,
}

impl Default for Effort {
    /// Doubling them changed no probability by more than 0.011 in the study of
    /// `docs/evidence.md`.
    fn default() -> Self {
        Self { beam: 4, branches: 6, of_a_name: 2, members: 24, detours: 240 }
    }
}

/// Models less probable than the best by this factor (nats) count as
/// impossible: a thousand of them would hold 1e-8 of the probability.
pub const WINDOW: f64 = 25.0;
/// The beam ends when its best model is this far behind (nats): two needless
/// additions.
const BEHIND: f64 = 15.0;
/// Models within this of the best (nats) have their members replaced: the
/// others hold less than a thousandth each.
const FRONT: f64 = 7.0;

/// Additions in a row on a way round a best model.
const DETOUR: usize = 4;
/// Pairs of a best model's members that are taken out together, the ones whose
/// coefficients hang on each other most.
const PAIRS: usize = 12;

/// Log mass of every model that was seen.
pub type Masses = BTreeMap<Vec<usize>, f64>;

/// A search under way.
pub(super) struct Search<'a> {
    subsets: &'a Subsets,
    effort: Effort,
    masses: Masses,
    fitted: BTreeMap<Vec<usize>, Subset>,
    /// Additions worth a fit of every model that was expanded.
    expanded: BTreeMap<Vec<usize>, Vec<Vec<usize>>>,
    best: f64,
}

impl<'a> Search<'a> {
    /// Looks from these models.
    pub fn run(subsets: &'a Subsets, effort: Effort, roots: &[Vec<usize>]) -> Self {
        let mut search = Self {
            subsets,
            effort,
            masses: BTreeMap::new(),
            fitted: BTreeMap::new(),
            expanded: BTreeMap::new(),
            best: f64::NEG_INFINITY,
        };
        for root in roots {
            search.climb(root.clone());
        }
        search.look_around();
        search
    }

    /// Every model and its log mass.
    pub fn masses(&self) -> &Masses {
        &self.masses
    }

    /// The fit of a model.
    pub fn fit(&mut self, members: &[usize]) -> &Subset {
        self.fit_all([(members, &[][..])]);
        &self.fitted[members]
    }

    /// Fits those models that are not yet, side by side; the prior sizes of what a model came
    /// from are the first guess.
    fn fit_all<'m>(&mut self, models: impl IntoIterator<Item = (&'m [usize], &'m [usize])>) {
        let mut new: BTreeMap<&[usize], Option<&Subset>> = BTreeMap::new();
        for (members, parent) in models {
            if !self.fitted.contains_key(members) {
                new.entry(members).or_insert_with(|| self.fitted.get(parent));
            }
        }
        let fit = |(members, parent): (&[usize], Option<&Subset>)| {
            let hint = |g: usize| {
                let parent = parent?;
                parent.members.iter().position(|m| *m == g).map(|i| parent.sizes[i])
            };
            (members.to_vec(), self.subsets.fit(members, &hint))
        };
        let fitted: Vec<(Vec<usize>, Subset)> = new.into_par_iter().map(fit).collect();
        for (members, subset) in fitted {
            self.best = self.best.max(subset.log_mass);
            self.masses.insert(members.clone(), subset.log_mass);
            self.fitted.insert(members, subset);
        }
    }

    fn climb(&mut self, root: Vec<usize>) {
        self.fit(&root);
        let mut beam = vec![root];
        for _ in 0..self.effort.members {
            let grown: BTreeMap<Vec<usize>, f64> =
                self.grow(&beam).into_iter().flatten().map(|(mass, m)| (m, mass)).collect();
            let mut grown: Vec<(f64, Vec<usize>)> =
                grown.into_iter().map(|(members, mass)| (mass, members)).collect();
            grown.sort_by(best_first);
            grown.truncate(self.effort.beam);
            if grown.first().is_none_or(|(mass, _)| *mass < self.best - BEHIND) {
                break;
            }
            beam = grown.into_iter().map(|(_, members)| members).collect();
        }
    }

    /// Rates every addition to fitted models, side by side.
    fn expand(&mut self, models: &[Vec<usize>]) {
        let new = models.iter().filter(|m| !self.expanded.contains_key(*m));
        let new: BTreeSet<&Vec<usize>> = new.collect();
        let room = |members: &[usize]| members.len() < self.effort.members;
        let rate = |members: &Vec<usize>| match room(members) {
            true => self.subsets.additions(&self.fitted[members]),
            false => Vec::new(),
        };
        let rated: Vec<Vec<f64>> = new.par_iter().map(|members| rate(members)).collect();
        for (members, additions) in new.into_iter().zip(rated) {
            let children = self.children(members, &additions);
            self.expanded.insert(members.clone(), children);
        }
    }

    /// Of the additions to a model those worth a fit.
    fn children(&mut self, members: &[usize], additions: &[f64]) -> Vec<Vec<usize>> {
        let mut order: Vec<usize> = (0..additions.len()).collect();
        order.sort_by(|a, b| additions[*b].total_cmp(&additions[*a]).then(a.cmp(b)));
        let mut out = Vec::new();
        let mut of_name: BTreeMap<usize, usize> = BTreeMap::new();
        // The best addition may be the best model of all.
        let best = order.first().map_or(self.best, |g| self.best.max(additions[*g]));
        for g in order {
            let mass = additions[g];
            if mass < best - WINDOW || !mass.is_finite() {
                break;
            }
            let at = members.partition_point(|m| *m < g);
            let mut child = members.to_vec();
            child.insert(at, g);
            // Of what was only rated the best rating stands, whoever comes first.
            let known = self.masses.entry(child.clone()).or_insert(mass);
            if !self.fitted.contains_key(&child) {
                *known = known.max(mass);
            }
            let same = of_name.entry(self.subsets.candidates()[g].name).or_default();
            *same += 1;
            if *same <= self.effort.of_a_name && out.len() < self.effort.branches {
                out.push(child);
            }
        }
        out
    }

    /// Takes each member of the best models out and tries all others instead;
    /// from a model that is the best of all also goes longer ways round.
    fn look_around(&mut self) {
        let mut seen: BTreeSet<Vec<usize>> = BTreeSet::new();
        let mut done = 0;
        while done < self.effort.detours {
            let near = self.masses.iter().filter(|(_, mass)| **mass >= self.best - FRONT);
            let front = near.filter(|(members, _)| !seen.contains(*members));
            let Some((members, mass)) = front.max_by(|a, b| a.1.total_cmp(b.1)) else { break };
            let (members, mass) = (members.clone(), *mass);
            seen.insert(members.clone());
            done += members.len().max(1);
            let steps = if mass >= self.best { DETOUR } else { 1 };
            self.fit(&members);
            let mut out: Vec<Vec<usize>> = members.iter().map(|m| vec![*m]).collect();
            if steps == DETOUR {
                let pairs = self.subsets.coupled(&self.fitted[&members], PAIRS);
                out.extend(pairs.into_iter().map(Vec::from));
            }
            self.grow(std::slice::from_ref(&members));
            self.detours(&members, out, steps);
        }
    }

    /// Takes some members out for good, climbs without them and then drops what
    /// is no longer needed: one effect may be imitated by two others. Goes all ways side by
    /// side.
    fn detours(&mut self, members: &[usize], out: Vec<Vec<usize>>, steps: usize) {
        let without = |out: &[usize]| -> Vec<usize> {
            members.iter().copied().filter(|m| !out.contains(m)).collect()
        };
        let mut now: Vec<Vec<usize>> = out.iter().map(|out| without(out)).collect();
        self.fit_all(now.iter().map(|now| (&now[..], members)));
        let mut going: Vec<usize> = (0..now.len()).collect();
        for _ in 0..steps {
            let from: Vec<Vec<usize>> = going.iter().map(|way| now[*way].clone()).collect();
            let grown = self.grow(&from);
            let next = going.into_iter().zip(grown).filter_map(|(way, grown)| {
                let stays_out = |child: &[usize]| child.iter().all(|m| !out[way].contains(m));
                let (better, child) = grown.into_iter().find(|(_, child)| stays_out(child))?;
                (better > self.masses[&now[way]]).then(|| {
                    now[way] = child;
                    way
                })
            });
            going = next.collect();
        }
        if steps > 1 {
            for now in now {
                let mass = self.masses[&now];
                if mass > self.best - BEHIND {
                    self.drop_needless(now, mass);
                }
            }
        }
    }

    fn drop_needless(&mut self, mut now: Vec<usize>, mut mass: f64) {
        loop {
            let from = now.clone();
            let less = |member: &usize| from.iter().copied().filter(|m| m != member).collect();
            let less: Vec<Vec<usize>> = from.iter().map(less).collect();
            self.fit_all(less.iter().map(|less| (&less[..], &from[..])));
            for less in less {
                let without = self.masses[&less];
                if without > mass {
                    (mass, now) = (without, less);
                }
            }
            if now == from {
                break;
            }
        }
    }

    /// Fits the additions worth it to each of these models, best first.
    fn grow(&mut self, models: &[Vec<usize>]) -> Vec<Vec<(f64, Vec<usize>)>> {
        self.expand(models);
        let children: Vec<Vec<Vec<usize>>> =
            models.iter().map(|members| self.expanded[members].clone()).collect();
        let pairs = models.iter().zip(&children);
        self.fit_all(pairs.flat_map(|(m, all)| all.iter().map(|child| (&child[..], &m[..]))));
        let rated = children.into_iter().map(|all| {
            let mut out: Vec<_> =
                all.into_iter().map(|child| (self.masses[&child], child)).collect();
            out.sort_by(best_first);
            out
        });
        rated.collect()
    }
}

/// By mass, and in a fixed order where it is the same.
fn best_first(a: &(f64, Vec<usize>), b: &(f64, Vec<usize>)) -> Ordering {
    b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1))
}
