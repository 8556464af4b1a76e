//! What the data hold beyond geometry: rounds of linearising at the best model
//! so far, weighing every candidate by its evidence, and fitting what was found.
//! It is to take the place of [`super::search`], by which `diagnose` still
//! decides.

mod halves;
mod lines;
mod nameless;
mod node;
mod possible;
mod sheet;

use nalgebra::DVector;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::candidates::{Candidate, arm_terms};
use super::policy::POLICY;
use crate::error::Result;
use crate::evidence::poses::{Readings, common_share};
use crate::evidence::tails::{Rest, Tails};
use crate::evidence::{Claim, Effort, Explanation, Gram, Subsets, explain};
use crate::identify::folds::{self, Fold};
use crate::identify::robust::Flags;
use crate::identify::{Problem, State};
use crate::observations::Residual;
use lines::Held;
pub use nameless::Nameless;
pub use node::{Node, fitted};
use possible::{NAMELESS, Numbers, Possible, What, revolute};
use sheet::{Sheet, Solution, Weights};

/// What is asked.
pub struct Question<'a> {
    /// Geometry only.
    pub problem: &'a Problem<'a>,
    /// Candidates of known form.
    pub offered: &'a [Candidate],
    /// Highest order of a line.
    pub highest_order: f64,
    /// Lambda and flags.
    pub flags: Flags,
    /// Rows.
    pub rows: &'a [usize],
    /// Folds of the nested cross-validation.
    pub folds: &'a [Fold],
    /// Most terms of the arm that the model may have.
    pub most_terms: usize,
}

/// A name at a place, and what speaks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Name of the effect.
    pub name: &'static str,
    /// As in reports.
    pub joints: Vec<usize>,
    /// That the arm has it.
    pub probability: f64,
    /// Fall of the error of each half of the poses when it is fitted to the
    /// other one.
    pub half_gain: [f64; 2],
    /// Whether both halves agree on it.
    pub replicated: bool,
}

/// The answer.
pub struct Weighed {
    /// The most probable model, fitted.
    pub best: Node,
    /// Its names, and others that have some probability.
    pub names: Vec<Named>,
    /// Structure without a name, with probability.
    pub nameless: Vec<(Nameless, f64)>,
    /// The most probable models that make other claims, with their odds to the
    /// best one.
    pub rivals: Vec<(Vec<Candidate>, f64)>,
    /// Noise over the stated sigma.
    pub scale: f64,
    /// Held-out residuals, everything decided anew in each fold.
    pub nested: Vec<Option<Residual>>,
}

/// How far the search goes: arms with random-like gear curves take many lines.
const EFFORT: Effort = Effort { beam: 4, branches: 6, of_a_name: 2, members: 40, swaps: 24 };
/// Prior size of a candidate that is not in the best model, of [`SIZES`]: 5 floors.
///
/// [`SIZES`]: crate::evidence::prior::SIZES
const USUAL_SIZE: usize = 2;
/// Rounds of linearising and weighing.
const ROUNDS: usize = 4;

/// Weighs everything, from a fit of geometry.
///
/// # Errors
/// When a fit does not converge.
pub fn weigh(question: &Question, root: &Node, progress: &dyn Fn()) -> Result<Weighed> {
    let q = question;
    let mut node = root.clone();
    let mut held: Vec<Held> = Vec::new();
    let mut scale = 0.0;
    let mut weights = weights(q.problem, &node, 1.0);
    let lambda = q.flags.lambda;
    let mut refused: Vec<Candidate> = Vec::new();
    let mut round = 0;
    loop {
        round += 1;
        let state = node.fit.fit.state.clone();
        let rows = node.fit.kept.clone();
        let mut numbers = Numbers::default();
        let possible = candidates(q, &state, &rows, &weights, (lambda, scale), &held, &mut numbers);
        let possible: Vec<Possible> = possible.into_iter().filter(|p| !p.is(&refused)).collect();
        let sheet = Sheet::new(q.problem, &state, &possible, &weights);
        let precision = sheet.precision(lambda);
        let parts = Parts::new(q, &rows);
        let grams = sheet.grams(&parts.rows);
        let whole = joined(grams.iter());
        let entries: Vec<_> = possible.iter().map(|p| p.entry.clone()).collect();
        let found = explain(&whole, &precision, &entries, EFFORT);
        progress();
        scale = found.scale;
        let members: Vec<&Candidate> = listed(&possible, &found.best.members);
        let same = members.len() == node.added.len()
            && members.iter().all(|m| node.added.iter().any(|a| a.terms == m.terms));
        let added: Vec<Candidate> = members.into_iter().cloned().collect();
        held = lines_of(&added);
        if same || round == ROUNDS {
            let judge = Judge { q, possible: &possible, sheet: &sheet, precision: &precision };
            let within = judge.within(&whole, &found);
            let best =
                if same && within.len() == added.len() { node } else { fitted(q, within, &state)? };
            return Ok(judge.answer(best, &found, &parts, &grams));
        }
        node = fitted(q, added, &state)?;
        let bad = node.implausible();
        if !bad.is_empty() && round < ROUNDS {
            let kept = node.added.iter().filter(|c| !bad.contains(c)).cloned().collect();
            refused.extend(bad);
            node = fitted(q, kept, &state)?;
        }
        weights = self::weights(q.problem, &node, scale);
    }
}

/// Everything that is weighed in a round.
fn candidates(
    q: &Question,
    state: &State,
    rows: &[usize],
    weights: &Weights,
    (lambda, scale): (f64, f64),
    held: &[Held],
    numbers: &mut Numbers,
) -> Vec<Possible> {
    let mut out: Vec<Possible> =
        q.offered.iter().map(|candidate| numbers.offered(candidate.clone())).collect();
    let how = (lambda, scale, q.highest_order);
    out.extend(lines::offered(q.problem, state, rows, weights, how, held, numbers));
    let joints = revolute(q.problem);
    for (nameless, tried) in Nameless::all(q.problem, &joints, POLICY.wobbles) {
        out.push(numbers.nameless(nameless, tried));
    }
    out
}

/// Members that a model can hold.
fn listed<'p>(possible: &'p [Possible], members: &[usize]) -> Vec<&'p Candidate> {
    let of = |m: &usize| match &possible[*m].what {
        What::Effect(candidate) => Some(candidate),
        What::Nameless(_) => None,
    };
    members.iter().filter_map(of).collect()
}

fn lines_of(added: &[Candidate]) -> Vec<Held> {
    let line = |c: &&Candidate| c.name() == truearm::effects::Effect::JointPeriodicError.name();
    let held = added.iter().filter(line).filter_map(|c| {
        let term = c.terms.first()?;
        Some((term.joints().first()? - 1, term.order()?))
    });
    held.collect()
}

/// What rows weigh after a fit.
fn weights(problem: &Problem, node: &Node, _scale: f64) -> Weights {
    let at = problem.linearise(&node.fit.fit.state);
    let scaled =
        |row: usize| at.residual(row).values().zip_map(&problem.scale(row), |r, s| r / s).to_vec();
    let kept = &node.fit.kept;
    let residuals: Vec<Vec<f64>> = kept.iter().map(|row| scaled(*row)).collect();
    let rest = |r: &Vec<f64>| Rest { square: r.iter().map(|x| x * x).sum(), equations: r.len() };
    let rests: Vec<Rest> = residuals.iter().map(rest).collect();
    let used = problem.unknowns.list().len() as f64;
    let tails = Tails::of(&rests, used.min(rests.len() as f64));
    let mut rows = vec![1.0; problem.data.rows.len()];
    for (row, rest) in kept.iter().zip(&rests) {
        rows[*row] = tails.weight(*rest);
    }
    Weights { rows, common: common(problem, kept, &residuals, used) }
}

/// Share of the noise that the readings of a pose have in common.
fn common(problem: &Problem, kept: &[usize], residuals: &[Vec<f64>], used: f64) -> f64 {
    let key = |k: usize| {
        let row = &problem.data.rows[kept[k]];
        (row.pose, row.station, row.marker, row.kind.0)
    };
    let mut order: Vec<usize> = (0..kept.len()).collect();
    order.sort_by_key(|k| (key(*k), *k));
    let poses = order.chunk_by(|a, b| key(*a) == key(*b)).map(|readings| {
        let equations = residuals[readings[0]].len();
        Readings::from_fn(equations, readings.len(), |e, r| residuals[readings[r]][e])
    });
    common_share(&poses.collect::<Vec<_>>(), used)
}

fn joined<'g>(grams: impl Iterator<Item = &'g Gram>) -> Gram {
    let mut grams = grams;
    let mut sum = grams.next().cloned().unwrap_or_else(|| Gram::new(0, 0));
    grams.for_each(|gram| sum.join(gram));
    sum
}

/// Rows by fold and by half, at random and in time.
struct Parts {
    rows: Vec<Vec<usize>>,
    fold: Vec<usize>,
    /// Which half, of each kind of halves.
    half: Vec<[usize; 2]>,
}

impl Parts {
    fn new(q: &Question, kept: &[usize]) -> Self {
        let data = q.problem.data;
        let mut fold_of = vec![0; data.rows.len()];
        for (k, fold) in q.folds.iter().enumerate() {
            fold.held_out.iter().for_each(|row| fold_of[*row] = k);
        }
        let mut random_half = vec![0; data.rows.len()];
        let mut poses: Vec<usize> = (0..data.poses).collect();
        poses.shuffle(&mut ChaCha8Rng::seed_from_u64(folds::SEED + 2));
        let second = &poses[data.poses / 2..];
        kept.iter()
            .for_each(|r| random_half[*r] = usize::from(second.contains(&data.rows[*r].pose)));
        // Poses in the order of the rows: the second half of a session.
        let middle = data.poses / 2;
        let mut out = Self { rows: Vec::new(), fold: Vec::new(), half: Vec::new() };
        for row in kept {
            let half = [random_half[*row], usize::from(data.rows[*row].pose >= middle)];
            let fold = fold_of[*row];
            let known = (0..out.rows.len()).find(|k| out.fold[*k] == fold && out.half[*k] == half);
            match known {
                Some(k) => out.rows[k].push(*row),
                None => {
                    out.rows.push(vec![*row]);
                    out.fold.push(fold);
                    out.half.push(half);
                }
            }
        }
        out
    }
}

/// A search's result about to be judged.
struct Judge<'s, 'a> {
    q: &'s Question<'a>,
    possible: &'s [Possible],
    sheet: &'s Sheet<'s>,
    precision: &'s DVector<f64>,
}

impl Judge<'_, '_> {
    fn answer(&self, best: Node, found: &Explanation, parts: &Parts, grams: &[Gram]) -> Weighed {
        let entries: Vec<_> = self.possible.iter().map(|p| p.entry.clone()).collect();
        let mut nested = vec![None; self.q.problem.data.rows.len()];
        for (k, fold) in self.q.folds.iter().enumerate() {
            let others = (0..grams.len()).filter(|p| parts.fold[*p] != k).map(|p| &grams[p]);
            let gram = joined(others);
            let own = explain(&gram, self.precision, &entries, EFFORT);
            let solution = self.solution(&gram, own.scale, &own.best.members, &own);
            for (row, left) in self.sheet.left(&fold.held_out, &solution) {
                nested[row] = Some(left);
            }
        }
        let claims = found.posterior.claims();
        let mut names = Vec::new();
        let mut nameless: Vec<(Nameless, f64)> = Vec::new();
        for (claim, probability) in claims {
            if probability < POLICY.worth_a_word {
                continue;
            }
            let of = |p: &&Possible| Claim::from(&p.entry) == claim;
            match self.possible.iter().find(of).map(|p| &p.what) {
                Some(What::Nameless(what)) => nameless.push((*what, probability)),
                Some(What::Effect(candidate)) => {
                    let (half_gain, replicated) =
                        halves::of_claim(self, claim, found, parts, grams);
                    names.push(Named {
                        name: candidate.name(),
                        joints: candidate.joints(),
                        probability,
                        half_gain,
                        replicated,
                    });
                }
                None => {}
            }
        }
        names.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        Weighed { best, names, nameless, rivals: self.rivals(found), scale: found.scale, nested }
    }

    /// The best model's candidates; where it has more terms of the arm than are
    /// asked for, those go that explain least a term.
    fn within(&self, gram: &Gram, found: &Explanation) -> Vec<Candidate> {
        let mut members = found.best.members.clone();
        let terms = |members: &[usize]| {
            let added: Vec<Candidate> =
                listed(self.possible, members).into_iter().cloned().collect();
            arm_terms(&added)
        };
        if terms(&members) > self.q.most_terms {
            let projected = gram.project(&gram.geometry(self.precision, found.scale));
            let entries = self.possible.iter().map(|p| p.entry.clone()).collect();
            let subsets = Subsets::new(projected, entries);
            while terms(&members) > self.q.most_terms {
                let with = subsets.fit(&members, &|_| None).log_mass;
                let cost = |m: &usize| {
                    let less: Vec<usize> = members.iter().copied().filter(|o| o != m).collect();
                    let own = (terms(&members) - terms(&less)) as f64;
                    (with - subsets.fit(&less, &|_| None).log_mass) / own
                };
                let of_arm = members.iter().filter(|m| terms(&[**m]) > 0);
                let rated = of_arm.map(|m| (cost(m), *m));
                let Some((_, least)) = rated.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
                members.retain(|m| *m != least);
            }
        }
        listed(self.possible, &members).into_iter().cloned().collect()
    }

    /// The most probable models with other claims, of some probability.
    fn rivals(&self, found: &Explanation) -> Vec<(Vec<Candidate>, f64)> {
        let claims = |members: &[usize]| {
            let mut out: Vec<Claim> =
                members.iter().map(|m| Claim::from(&self.possible[*m].entry)).collect();
            out.sort();
            out.dedup();
            out
        };
        let best = found.posterior.models.first().map_or(1.0, |m| m.1);
        let mut seen = vec![claims(&found.best.members)];
        let mut out: Vec<(Vec<Candidate>, f64)> = Vec::new();
        for (members, probability) in &found.posterior.models {
            let own = claims(members);
            let odds = probability / best;
            if odds < POLICY.odds || seen.contains(&own) {
                continue;
            }
            let plain = own.iter().all(|claim| claim.name < NAMELESS);
            if plain {
                let added = listed(self.possible, members).into_iter().cloned().collect();
                out.push((added, odds));
            }
            seen.push(own);
        }
        out
    }

    /// Coefficients of an explanation as those of all columns.
    fn solution(&self, gram: &Gram, scale: f64, members: &[usize], own: &Explanation) -> Solution {
        let each = members.iter().zip(&own.coefficients);
        let values = each.map(|(m, c)| (*m, c.iter().map(|c| c.value).collect()));
        self.spread(gram, scale, values.collect())
    }

    fn spread(&self, gram: &Gram, scale: f64, of: Vec<(usize, Vec<f64>)>) -> Solution {
        let mut columns = DVector::zeros(sheet::columns_of(self.possible));
        for (member, values) in of {
            let first: usize = self.possible[..member].iter().map(Possible::count).sum();
            values.iter().enumerate().for_each(|(k, value)| columns[first + k] = *value);
        }
        self.sheet.solved(gram, self.precision, scale, columns)
    }

    /// Members refitted to some rows, their prior sizes as they are in the whole:
    /// coefficients, their deviations, and what geometry goes with them. Rows that
    /// say nothing of a coefficient leave it as uncertain as its prior.
    fn refitted(
        &self,
        gram: &Gram,
        found: &Explanation,
        members: &[usize],
    ) -> (Vec<Vec<crate::evidence::Coefficient>>, Solution) {
        let projected = gram.project(&gram.geometry(self.precision, found.scale));
        let entries = self.possible.iter().map(|p| p.entry.clone()).collect();
        let subsets = Subsets::new(projected, entries);
        let size = |m: &usize| {
            let place = found.best.members.iter().position(|own| own == m);
            place.map_or(USUAL_SIZE, |k| found.best.sizes[k])
        };
        let sizes: Vec<usize> = members.iter().map(size).collect();
        let subset = subsets.at_sizes(members, &sizes);
        let coefficients = subsets.coefficients(&subset);
        let values = members
            .iter()
            .zip(&coefficients)
            .map(|(m, c)| (*m, c.iter().map(|c| c.value).collect()))
            .collect();
        let solution = self.spread(gram, found.scale, values);
        (coefficients, solution)
    }
}
