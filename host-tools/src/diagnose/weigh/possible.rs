//! What may be in a model: effects that a report can name, at every place that
//! the data can test, and structure that has no name.

use std::collections::BTreeMap;

use nalgebra::{DVector, Vector3};
use truearm::JointKind;
use truearm::effects::Term;

use super::curve::Curve;
use super::nameless::{self, Nameless};
use crate::diagnose::bending;
use crate::diagnose::candidates::Candidate;
use crate::evidence::lines::Line;
use crate::evidence::{self, Coefficient, Explanation, lines, prior};
use crate::identify::{Problem, measurement_column};
use crate::model::ModelTerm;
use crate::model::arm::Derivatives;

/// Number from which on a name of the evidence is a structure without a name.
pub const NAMELESS: usize = 1000;

/// A candidate with its columns.
#[derive(Debug, Clone)]
pub struct Possible {
    /// What it is.
    pub what: What,
    /// How it stands in the evidence.
    pub entry: evidence::Candidate,
}

/// What a candidate is.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Terms of a model, coefficients zero.
    Effect(Candidate),
    /// Nothing that a model can hold.
    Nameless(Nameless),
}

impl Possible {
    /// How many columns.
    #[must_use]
    pub fn count(&self) -> usize {
        self.entry.units.len()
    }

    /// Whether it is one of these.
    #[must_use]
    pub fn is(&self, these: &[Candidate]) -> bool {
        matches!(&self.what, What::Effect(own) if these.iter().any(|c| c.terms == own.terms))
    }

    /// Whether it does what a curve of its joint does: an eccentricity, or a line
    /// within the curve's orders.
    #[must_use]
    pub fn is_within(&self, curves: &[Curve]) -> bool {
        let What::Effect(candidate) = &self.what else { return false };
        let orders: Vec<f64> =
            candidate.terms.iter().map(|t| t.order().unwrap_or(f64::INFINITY)).collect();
        curves.iter().any(|curve| {
            candidate.joints() == [curve.joint + 1]
                && orders.iter().all(|order| *order <= curve.orders() as f64)
        })
    }

    /// Whether it is a course in time.
    #[must_use]
    pub fn is_of_time(&self) -> bool {
        matches!(&self.what, What::Effect(own)
            if own.terms.iter().any(|t| matches!(t, ModelTerm::Drift { .. })))
    }

    /// Whether moments of the links bend it.
    #[must_use]
    pub fn is_spring(&self) -> bool {
        matches!(&self.what, What::Effect(own) if bending::bends(own.name()))
    }

    /// Its terms with coefficient zero, `None` for each column that is no term.
    pub fn coefficients_zero(&self) -> Vec<Option<ModelTerm>> {
        match &self.what {
            What::Effect(candidate) => candidate.terms.iter().cloned().map(Some).collect(),
            What::Nameless(_) => vec![None; self.count()],
        }
    }

    /// Its terms, where they are of the arm.
    pub fn arm_terms(&self) -> impl Iterator<Item = Term<f64>> {
        let terms = match &self.what {
            What::Effect(candidate) => &candidate.terms[..],
            What::Nameless(_) => &[],
        };
        terms.iter().filter_map(|term| match term {
            ModelTerm::Arm(term) => Some(*term),
            _ => None,
        })
    }

    /// How the target of a row moves with each of its coefficients, SI.
    #[must_use]
    pub fn columns(&self, problem: &Problem, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let terms: Vec<Term<f64>> = self.arm_terms().collect();
        self.columns_by(problem, index, d, &mut of_arm(problem, &terms, index, d))
    }

    /// The same, those of its terms of the arm being the next of these.
    pub fn columns_by(
        &self,
        problem: &Problem,
        index: usize,
        d: &Derivatives,
        of_arm: &mut impl Iterator<Item = Vector3<f64>>,
    ) -> Vec<Vector3<f64>> {
        let mut column = |term: &ModelTerm| match term {
            ModelTerm::Arm(_) => of_arm.next().unwrap_or_else(Vector3::zeros),
            _ => measurement_column(term, &problem.data.rows[index], d),
        };
        match &self.what {
            What::Effect(candidate) => candidate.terms.iter().map(&mut column).collect(),
            What::Nameless(nameless) => nameless.columns(problem, index, d),
        }
    }
}

/// How the target of a row moves with the coefficients of terms of the arm.
pub fn of_arm(
    problem: &Problem,
    terms: &[Term<f64>],
    index: usize,
    d: &Derivatives,
) -> impl Iterator<Item = Vector3<f64>> {
    let (row, inputs) = (&problem.data.rows[index], &problem.conditions.rows[index]);
    d.columns(terms, inputs, &row.q, &problem.nominal).into_iter()
}

/// Numbers for the names and places of candidates.
#[derive(Debug, Default)]
pub struct Numbers {
    names: Vec<&'static str>,
    places: BTreeMap<Vec<usize>, usize>,
}

impl Numbers {
    /// The number of a name.
    pub fn name(&mut self, name: &'static str) -> usize {
        if let Some(k) = self.names.iter().position(|n| *n == name) {
            return k;
        }
        self.names.push(name);
        self.names.len() - 1
    }

    /// The number of a place: joints counted from 1.
    pub fn place(&mut self, joints: Vec<usize>) -> usize {
        let next = self.places.len();
        *self.places.entry(joints).or_insert(next)
    }

    /// A candidate of known form.
    pub fn offered(&mut self, candidate: Candidate) -> Possible {
        let entry = evidence::Candidate {
            name: self.name(candidate.name()),
            place: self.place(place(&candidate)),
            part: 0,
            common: candidate.time_constant().to_bits(),
            units: units(&candidate.terms),
            log_odds: prior::log_odds(candidate.tried as usize, 1),
        };
        Possible { what: What::Effect(candidate), entry }
    }

    /// The `part`-th line of a joint, at one of its possible orders.
    pub fn line(&mut self, candidate: Candidate, part: usize, log_odds: f64) -> Possible {
        let mut out = self.offered(candidate);
        out.entry.part = part;
        out.entry.log_odds = log_odds;
        out
    }

    /// A structure without a name, of so many of its kind.
    pub fn nameless(&mut self, nameless: Nameless, tried: usize) -> Possible {
        let entry = evidence::Candidate {
            name: NAMELESS + nameless.kind(),
            place: self.place(nameless.joint().map(|joint| joint + 1).into_iter().collect()),
            part: nameless.part(),
            common: 0,
            units: nameless.units(),
            log_odds: prior::log_odds(tried, 1),
        };
        Possible { what: What::Nameless(nameless), entry }
    }
}

/// Joints counted from 1; of a remount, which series.
fn place(candidate: &Candidate) -> Vec<usize> {
    match candidate.terms.first() {
        Some(ModelTerm::Remount { series, .. }) => {
            // A number of its own that no joint has.
            vec![series.bytes().fold(1000, |h: usize, b| h.wrapping_mul(31).wrapping_add(b.into()))]
        }
        _ => candidate.joints(),
    }
}

/// Columns of one unit have one number.
fn units(terms: &[ModelTerm]) -> Vec<usize> {
    let lengths = |t: &ModelTerm| match t {
        ModelTerm::Drift { component, .. } => usize::from(*component >= 3),
        _ => 0,
    };
    terms.iter().map(lengths).collect()
}

/// Revolute joints.
pub fn revolute(problem: &Problem) -> Vec<usize> {
    let is = |j: &usize| problem.nominal[*j].kind == JointKind::Revolute;
    (0..problem.nominal.len()).filter(is).collect()
}

/// Orders of a line that are candidates: near one another they are one line.
pub fn variants(orders: &lines::Orders, line: &Line) -> Vec<f64> {
    // A blob holds orders in 1/64 of a cycle.
    let mut out: Vec<f64> =
        orders.variants(line).into_iter().map(|n| (n * 64.0).round() / 64.0).collect();
    out.dedup();
    out
}

/// Which of the candidates a fitted model has.
#[must_use]
pub fn members_of(possible: &[Possible], added: &[Candidate]) -> Vec<usize> {
    (0..possible.len()).filter(|k| possible[*k].is(added)).collect()
}

/// Members that a model can hold.
#[must_use]
pub fn listed<'p>(possible: &'p [Possible], members: &[usize]) -> Vec<&'p Candidate> {
    let of = |m: &usize| match &possible[*m].what {
        What::Effect(candidate) => Some(candidate),
        What::Nameless(_) => None,
    };
    members.iter().filter_map(of).collect()
}

/// What the most probable model has that has no name.
#[must_use]
pub fn nameless(possible: &[Possible], found: &Explanation) -> Vec<nameless::Held> {
    let each = found.best.members.iter().zip(&found.coefficients);
    let of = |(m, coefficients): (&usize, &Vec<Coefficient>)| match &possible[*m].what {
        What::Nameless(what) => {
            let values = coefficients.iter().map(|c| c.value);
            Some((*what, DVector::from_iterator(coefficients.len(), values)))
        }
        What::Effect(_) => None,
    };
    each.filter_map(of).collect()
}

/// Whether both are of the same kinds at the same places.
#[must_use]
pub fn same(a: &[nameless::Held], b: &[nameless::Held]) -> bool {
    let place = |(what, _): &nameless::Held| (what.kind(), what.joint(), what.part());
    a.len() == b.len() && a.iter().all(|own| b.iter().any(|other| place(own) == place(other)))
}

/// Where the columns of a candidate stand among those of all.
#[must_use]
pub fn columns_of_member(possible: &[Possible], member: usize) -> std::ops::Range<usize> {
    let first = columns_of(&possible[..member]);
    first..first + possible[member].count()
}

/// Columns of all candidates together.
#[must_use]
pub fn columns_of(possible: &[Possible]) -> usize {
    possible.iter().map(Possible::count).sum()
}
