//! Which subsets of the candidates hold the probability: a deterministic
//! search. A beam climbs from nothing (and from known models), giving every
//! name a turn because one missing effect makes many others look significant;
//! then the best models are looked at once more from all sides, each member
//! taken out and everything else tried in its place, and of the best of all
//! pairs that hang together, with a new climb from there. Every model one addition
//! away from a model that was expanded is kept with its probability, so that
//! the sum over look-alikes is complete where it matters.

use std::collections::{BTreeMap, BTreeSet};

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
        self.fit_from(members, &[])
    }

    /// Prior sizes of `parent` are the first guess.
    fn fit_from(&mut self, members: &[usize], parent: &[usize]) -> &Subset {
        if !self.fitted.contains_key(members) {
            let parent = self.fitted.get(parent);
            let hint = |g: usize| {
                let parent = parent?;
                parent.members.iter().position(|m| *m == g).map(|i| parent.sizes[i])
            };
            let subset = self.subsets.fit(members, &hint);
            self.best = self.best.max(subset.log_mass);
            self.masses.insert(members.to_vec(), subset.log_mass);
            self.fitted.insert(members.to_vec(), subset);
        }
        &self.fitted[members]
    }

    fn climb(&mut self, root: Vec<usize>) {
        self.fit(&root);
        let mut beam = vec![root];
        for _ in 0..self.effort.members {
            let mut grown: BTreeSet<Vec<usize>> = BTreeSet::new();
            for parent in &beam {
                for child in self.expand(parent) {
                    self.fit_from(&child, parent);
                    grown.insert(child);
                }
            }
            let mut grown: Vec<(f64, Vec<usize>)> =
                grown.into_iter().map(|m| (self.masses[&m], m)).collect();
            grown.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
            grown.truncate(self.effort.beam);
            if grown.first().is_none_or(|(mass, _)| *mass < self.best - BEHIND) {
                break;
            }
            beam = grown.into_iter().map(|(_, members)| members).collect();
        }
    }

    /// Rates every addition to a model; those worth a fit.
    fn expand(&mut self, members: &[usize]) -> Vec<Vec<usize>> {
        if let Some(known) = self.expanded.get(members) {
            return known.clone();
        }
        let children =
            if members.len() < self.effort.members { self.children(members) } else { Vec::new() };
        self.expanded.insert(members.to_vec(), children.clone());
        children
    }

    fn children(&mut self, members: &[usize]) -> Vec<Vec<usize>> {
        let additions = self.subsets.additions(&self.fit(members).clone());
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
            self.masses.entry(child.clone()).or_insert(mass);
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
            let front = self.masses.iter().filter(|(m, _)| !seen.contains(*m));
            let Some((members, mass)) = front.max_by(|a, b| a.1.total_cmp(b.1)) else { break };
            let (members, mass) = (members.clone(), *mass);
            if mass < self.best - FRONT {
                break;
            }
            seen.insert(members.clone());
            done += members.len().max(1);
            let steps = if mass >= self.best { DETOUR } else { 1 };
            let subset = self.fit(&members).clone();
            self.grow(&members);
            for member in &members {
                self.detour(&members, &[*member], steps);
            }
            if steps == DETOUR {
                for pair in self.subsets.coupled(&subset, PAIRS) {
                    self.detour(&members, &pair, steps);
                }
            }
        }
    }

    /// Takes some members out for good, climbs without them and then drops what
    /// is no longer needed: one effect may be imitated by two others.
    fn detour(&mut self, members: &[usize], out: &[usize], steps: usize) {
        let mut now: Vec<usize> = members.iter().copied().filter(|m| !out.contains(m)).collect();
        let mut mass = self.fit_from(&now, members).log_mass;
        for _ in 0..steps {
            let Some((better, child)) = self
                .grow(&now)
                .into_iter()
                .find(|(_, child)| child.iter().all(|m| !out.contains(m)))
            else {
                break;
            };
            if better <= mass {
                break;
            }
            (mass, now) = (better, child);
        }
        if steps > 1 && mass > self.best - BEHIND {
            self.drop_needless(now, mass);
        }
    }

    fn drop_needless(&mut self, mut now: Vec<usize>, mut mass: f64) {
        loop {
            let from = now.clone();
            for member in &from {
                let less: Vec<usize> = from.iter().copied().filter(|m| m != member).collect();
                let without = self.fit_from(&less, &from).log_mass;
                if without > mass {
                    (mass, now) = (without, less);
                }
            }
            if now == from {
                break;
            }
        }
    }

    /// Fits the additions worth it, best first.
    fn grow(&mut self, members: &[usize]) -> Vec<(f64, Vec<usize>)> {
        let mut out: Vec<(f64, Vec<usize>)> = Vec::new();
        for child in self.expand(members) {
            out.push((self.fit_from(&child, members).log_mass, child));
        }
        out.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
        out
    }
}
