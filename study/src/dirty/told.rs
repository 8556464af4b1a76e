//! Which hidden effects anyone could name who is told everything else: the noise, and
//! which other effects there are.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use truearm::JointKind;
use truearm::effects::Effect;
use truearm_host::effects::{Data, Offer, offers};
use truearm_host::evidence::poses::whiten;
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Linearised, Problem, Scaling, State};
use truearm_host::model::{ModelTerm, Mounting, Robot};
use truearm_simulate::body::Moment;

use super::set::{DirtySet, Secret};
use super::truth::{Place, moved};
use crate::apart::{Apart, TOLD, apart, runs};
use crate::simulated::{parse, robot};
use crate::terms::terms;

/// How far a hidden effect is from everything else.
#[derive(Debug, Clone)]
pub struct Alone {
    /// From nothing, in standard deviations of its bound.
    pub from_nothing: f64,
    /// From nothing or its nearest rival.
    pub sure: f64,
    /// Who could stand in its place, though it cannot be nothing.
    pub alike: Vec<Place>,
}

/// Orders of lines that are rivals, whole ones: those that may be hidden.
const LINES: std::ops::RangeInclusive<u32> = 3..=60;

/// Poses that are read at a time.
const POSES: usize = 128;

/// Of every listed effect and then of the one without a name, if there is one; `None`
/// where the arm cannot be registered.
pub fn alone(set: &DirtySet) -> Option<Vec<Alone>> {
    let secret = set.open();
    // Equations in metres: the true noise comes later.
    let robot = Robot { sigma: 1.0, ..robot(&set.robot) };
    let loaded = robot.with_assumed_loads(Mounting::Upright);
    let (assumed, robot) = (loaded.is_some(), loaded.unwrap_or(robot));
    let data = parse(&robot, &set.measurements);
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let hidden = secret.hidden.listed.iter().map(|d| terms(&d.kind, &secret.arm.gear_ratios));
    let hidden: Vec<Vec<ModelTerm>> = hidden.collect::<Option<_>>()?;
    let known: Vec<Place> = hidden.iter().map(|terms| place(terms)).collect();
    let rivals = repertoire(&problem, &robot, assumed).into_iter().map(|offer| offer.terms);
    let rivals: Vec<_> = rivals.filter(|terms| !known.contains(&place(terms))).collect();

    let all: Vec<_> = hidden.iter().chain(&rivals).flatten().cloned().collect();
    let start = register(&data, &problem.nominal, robot.tool).ok()?;
    let problem = problem.with_terms(all.len());
    let gram = gram(secret, &problem, &State { terms: all, ..start });
    let columns = Columns::of(&problem, &hidden, &rivals, gram);
    let alone = |own: usize| {
        let Apart { from_nothing, from_rivals } = columns.apart(own);
        // Of lines there are so many that each has a hundredth of another's prior.
        let with_lines = hidden.get(own).is_none_or(|terms| is_line(terms));
        let rivals = from_rivals.into_iter().zip(&rivals);
        let rivals: Vec<_> = rivals.filter(|(_, r)| with_lines || !is_line(r)).collect();
        let near = rivals.iter().filter(|(d, _)| from_nothing >= TOLD && *d < TOLD);
        let alike = near.map(|(_, terms)| place(terms)).collect();
        let sure = rivals.iter().map(|(d, _)| *d).fold(from_nothing, f64::min);
        Alone { from_nothing, sure, alike }
    };
    Some((0..columns.effects()).map(alone).collect())
}

fn is_line(terms: &[ModelTerm]) -> bool {
    place(terms).0 == Effect::JointPeriodicError.name()
}

fn place(terms: &[ModelTerm]) -> Place {
    let first = terms.first();
    first.map(|term| (term.effect_name().to_owned(), term.joints())).unwrap_or_default()
}

/// What a diagnosis may name.
fn repertoire(problem: &Problem, robot: &Robot, assumed: bool) -> Vec<Offer> {
    let (mut out, _) = offers(&Data { robot, conditions: &problem.conditions, assumed });
    let line = |joint, order: u32| {
        Offer::of_arm(Effect::JointPeriodicError, &[joint], &[f64::from(order)], 1)
    };
    let links = problem.nominal.iter().enumerate();
    let revolute = links.filter(|(_, link)| link.kind == JointKind::Revolute);
    out.extend(revolute.flat_map(|(joint, _)| LINES.map(move |order| line(joint, order))));
    out
}

/// Of all unknowns at a state and then of what each hidden effect really does, in true
/// standard deviations, tolerances included.
fn gram(secret: &Secret, problem: &Problem, state: &State) -> DMatrix<f64> {
    let hidden = &secret.hidden;
    let of = |defects| moved(&secret.arm, defects, &secret.moments);
    let mut effects: Vec<DVector<f64>> =
        hidden.listed.iter().map(|d| of(std::slice::from_ref(d))).collect();
    effects.extend(hidden.unlisted.iter().map(|(_, defects)| of(defects)));
    let (at, unknowns) = (problem.linearise(state), problem.unknowns.list().len());
    let size = unknowns + effects.len();
    let mut out = DMatrix::zeros(size, size);
    let mut first = 0;
    let poses: Vec<_> = secret.moments.chunk_by(|a, b| a.q == b.q).collect();
    for poses in poses.chunks(POSES) {
        let blocks = poses.iter().map(|readings| {
            let block = pose(&at, first, readings.len(), &effects);
            first += readings.len();
            whitened(block, readings, secret)
        });
        let blocks: Vec<_> = blocks.collect();
        let mut rows = DMatrix::zeros(blocks.iter().map(DMatrix::nrows).sum(), size);
        let mut from = 0;
        for block in &blocks {
            rows.rows_mut(from, block.nrows()).copy_from(block);
            from += block.nrows();
        }
        out.gemm(1.0, &rows.transpose(), &rows, 1.0);
    }
    (problem.unknowns.free()..unknowns).for_each(|k| out[(k, k)] += 1.0);
    out
}

/// Equations of the readings of a pose, m.
fn pose(at: &Linearised, first: usize, readings: usize, effects: &[DVector<f64>]) -> DMatrix<f64> {
    let blocks: Vec<_> = (first..first + readings).map(|row| at.equations(row).block).collect();
    let unknowns = blocks[0].ncols();
    let mut out = DMatrix::zeros(3 * readings, unknowns + effects.len());
    for (k, block) in blocks.iter().enumerate() {
        out.view_mut((3 * k, 0), (3, unknowns)).copy_from(block);
    }
    for (k, effect) in effects.iter().enumerate() {
        let own = effect.rows(3 * first, 3 * readings);
        out.view_mut((0, unknowns + k), (3 * readings, 1)).copy_from(&own);
    }
    out
}

/// The same in standard deviations of independent noise.
fn whitened(mut block: DMatrix<f64>, readings: &[Moment], secret: &Secret) -> DMatrix<f64> {
    let noise = &secret.noise;
    let range = secret.arm.point(&readings[0]).norm();
    let variances = [noise.of_pose, noise.of_reading * (1.0 + noise.range * range)].map(|s| s * s);
    let total: f64 = variances.iter().sum();
    block /= total.sqrt();
    whiten(&mut block, readings.len(), variances[0] / total);
    block
}

/// Which columns of the sum are whose.
struct Columns {
    gram: DMatrix<f64>,
    geometry: Vec<usize>,
    hidden: Vec<Range<usize>>,
    rivals: Vec<Range<usize>>,
    unknowns: usize,
}

impl Columns {
    fn of(
        problem: &Problem,
        hidden: &[Vec<ModelTerm>],
        rivals: &[Vec<ModelTerm>],
        gram: DMatrix<f64>,
    ) -> Self {
        let (terms, unknowns) = (problem.unknowns.terms(), problem.unknowns.list().len());
        let all = runs(terms.start, hidden.iter().chain(rivals).map(Vec::len));
        let (hidden, rivals) = all.split_at(hidden.len());
        Self {
            gram,
            geometry: (0..unknowns).filter(|k| !terms.contains(k)).collect(),
            hidden: hidden.to_vec(),
            rivals: rivals.to_vec(),
            unknowns,
        }
    }

    /// How many hidden effects there are.
    fn effects(&self) -> usize {
        self.gram.ncols() - self.unknowns
    }

    /// One of them, the terms of all others being free; of what no term describes its size.
    fn apart(&self, own: usize) -> Apart {
        let own = self.unknowns + own;
        let others = (0..self.hidden.len()).filter(|k| self.unknowns + k != own);
        let others = others.flat_map(|k| self.hidden[k].clone());
        let unlisted = (self.unknowns + self.hidden.len()..self.gram.ncols()).filter(|k| *k != own);
        let beside = self.geometry.iter().copied().chain(others).chain(unlisted);
        apart(&self.gram, own, &beside.collect::<Vec<_>>(), &self.rivals)
    }
}

#[cfg(test)]
mod tests {
    use super::super::set::Sort;
    use super::super::truth::floors;
    use super::*;

    /// With many poses read once, noise that does not grow with the range and effects that
    /// one coefficient describes, the distance from nothing is the size in noise floors.
    #[test]
    fn distance_is_size() {
        let set = DirtySet::draw(2_010_000_001, Sort::Session);
        let equations = 3.0 * set.open().moments.len() as f64;
        let distances = alone(&set).unwrap();
        for (alone, floors) in distances.iter().zip(floors(&set)) {
            let ratio = alone.from_nothing / (floors * equations.sqrt());
            assert!((0.95..1.05).contains(&ratio), "{ratio}");
            assert!(alone.sure <= alone.from_nothing);
        }
    }
}
