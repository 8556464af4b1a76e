//! Gaps of all joints beside everything else that rows are fitted by, and the sides of heads
//! that they tell.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector, Vector3};

use super::heads::Head;
use crate::diagnose::weigh::sheet::{Sheet, Weights};
use crate::identify::problem::accumulate::{CHUNK, tree};
use crate::identify::{Linearised, Problem, State};
use crate::model::arm::Derivatives;

/// Nats by which a side must be likelier than the other one: it is 20 times as probable.
/// Otherwise its rows count as in the middle, from which such a gap moves them by little more
/// than noise does: what a side that nothing tells would add to the evidence is chance.
const SURE: f64 = 3.0;
/// Of each diagonal entry, against joints whose gaps nobody could see.
const LEAST: f64 = 1e-9;
/// Most rounds through all stretches; two or three settle them.
const ROUNDS: usize = 6;

/// What heads are told beside: the problem whose sides are those of the order alone, and a
/// state of it that has no gaps.
#[derive(Clone, Copy)]
pub struct Beside<'p, 'q> {
    pub problem: &'p Problem<'q>,
    pub state: &'p State,
    pub lambda: f64,
    /// Friction of each joint's gap, above which gravity takes the side, 0: never.
    pub frictions: &'p [f64],
}

impl Beside<'_, '_> {
    /// The side that a joint is known to have come from; 0 where nothing tells it.
    fn side(&self, row: usize, joint: usize) -> f64 {
        let torque = self.problem.conditions.row(row).torque.get(joint).copied().unwrap_or(0.0);
        let friction = self.frictions[joint];
        if friction > 0.0 && torque.abs() > friction {
            // As if it had come from where gravity pulls it.
            return -torque.signum();
        }
        f64::from(self.problem.data.rows[row].directions.get(joint).copied().unwrap_or(0))
    }

    fn moved(&self, joint: usize, d: &Derivatives) -> Vector3<f64> {
        *d.links[joint].joint(self.problem.nominal[joint].kind)
    }

    /// Columns of the gaps of all joints where their sides are known.
    fn known(&self, row: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let joints = 0..self.problem.nominal.len();
        joints.map(|joint| self.moved(joint, d) * self.side(row, joint)).collect()
    }

    /// And of these heads where theirs are not.
    fn waiting(&self, row: usize, d: &Derivatives, heads: &[&Head]) -> Vec<Vector3<f64>> {
        let column = |head: &&Head| match head.rows.contains(&row) {
            true if self.side(row, head.joint) == 0.0 => self.moved(head.joint, d),
            _ => Vector3::zeros(),
        };
        heads.iter().map(column).collect()
    }

    /// Sums of squares and products of geometry, gaps and heads, and with residuals.
    fn sums(&self, at: &Linearised, rows: &[usize], heads: &[Head]) -> Sums {
        let known = |row: usize, d: &Derivatives| self.known(row, d);
        let leaf = |own: &[usize]| {
            let of = |row: &usize| {
                let e = at.equations_beside(*row, &known);
                let residual = e.scaled_residual();
                let right = e.block.tr_mul(&residual.column());
                let right = DVector::from_column_slice(right.as_slice());
                (e.block.tr_mul(&e.block), right, residual.norm_squared())
            };
            let both = |a: Sums, b: Sums| (a.0 + b.0, a.1 + b.1, a.2 + b.2);
            own.iter().map(of).reduce(both).unwrap_or_default()
        };
        let both = |a: Sums, b: Sums| (a.0 + b.0, a.1 + b.1, a.2 + b.2);
        let (normal, right, square) = tree(rows, CHUNK, &leaf, &both);
        let size = right.len();
        let mut out = (
            normal.resize(size + heads.len(), size + heads.len(), 0.0),
            right.resize_vertically(size + heads.len(), 0.0),
            square,
        );
        for row in rows {
            let ends = [Some(*row), self.problem.data.rows[*row].partner];
            let waits = |h: &usize| ends.iter().flatten().any(|r| heads[*h].rows.contains(r));
            let own: Vec<usize> = (0..heads.len()).filter(waits).collect();
            if !own.is_empty() {
                self.add(at, *row, heads, &own, &mut out);
            }
        }
        out
    }

    /// Adds what a row says of these heads.
    fn add(&self, at: &Linearised, row: usize, heads: &[Head], own: &[usize], to: &mut Sums) {
        let waiting: Vec<&Head> = own.iter().map(|h| &heads[*h]).collect();
        let e = at.equations_beside(row, &|i, d| {
            [self.known(i, d), self.waiting(i, d, &waiting)].concat()
        });
        let size = e.block.ncols() - own.len();
        let residual = e.scaled_residual();
        let products = e.block.tr_mul(&e.block.columns(size, own.len()));
        for (k, head) in own.iter().enumerate() {
            let at = size + head;
            to.1[at] += e.block.column(size + k).dot(&residual.column());
            for i in 0..size {
                to.0[(i, at)] += products[(i, k)];
                to.0[(at, i)] += products[(i, k)];
            }
            for (l, other) in own.iter().enumerate() {
                to.0[(size + other, at)] += products[(size + l, k)];
            }
        }
    }
}

/// Normal equations, their right-hand side, and the sum of squares of residuals.
type Sums = (DMatrix<f64>, DVector<f64>, f64);

/// Normal equations of gaps, everything else projected off: those of all joints where their
/// sides are known, then of heads.
pub struct Gaps<'h> {
    joints: usize,
    heads: &'h [Head],
    normal: DMatrix<f64>,
    right: DVector<f64>,
    /// Sum of squares without gaps.
    square: f64,
    freedom: f64,
}

impl<'h> Gaps<'h> {
    /// Of these rows.
    pub fn of(beside: &Beside, rows: &[usize], heads: &'h [Head]) -> Self {
        let Beside { problem, state, lambda, .. } = *beside;
        let (sums, right, square) = beside.sums(&problem.linearise(state), rows, heads);
        let joints = problem.nominal.len();
        let rigid = problem.unknowns.list().len();
        let gaps = joints + heads.len();
        let weights = Weights::alike(problem.data.rows.len());
        let precision = Sheet::new(problem, state, &[], &weights, &[]).precision(lambda);
        let geometry = sums.view((0, 0), (rigid, rigid)).into_owned()
            + DMatrix::from_diagonal(&precision.rows(0, rigid).into_owned());
        let mut out = Self {
            joints,
            heads,
            normal: sums.view((rigid, rigid), (gaps, gaps)).into_owned(),
            right: right.rows(rigid, gaps).into_owned(),
            square,
            freedom: (problem.equations(rows) as f64 - (rigid + joints) as f64).max(1.0),
        };
        if let Some(factor) = geometry.cholesky() {
            let both = sums.view((0, rigid), (rigid, gaps)).into_owned();
            let own = right.rows(0, rigid).into_owned();
            let solved = factor.solve(&own);
            out.normal -= both.tr_mul(&factor.solve(&both));
            out.right -= both.tr_mul(&solved);
            out.square -= own.dot(&solved);
        }
        out
    }

    /// The gaps of all joints with these sides of heads, and by how much the sum of squares
    /// falls with them.
    fn solved(&self, sides: &[i8]) -> (DVector<f64>, f64) {
        let told: Vec<(usize, usize, f64)> = (0..self.heads.len())
            .filter(|h| sides[*h] != 0)
            .map(|h| (self.heads[h].joint, self.joints + h, f64::from(sides[h])))
            .collect();
        let mut normal = self.normal.view((0, 0), (self.joints, self.joints)).into_owned();
        let mut right = self.right.rows(0, self.joints).into_owned();
        for (joint, at, side) in &told {
            right[*joint] += side * self.right[*at];
            for other in 0..self.joints {
                let product = side * self.normal[(other, *at)];
                normal[(other, *joint)] += product;
                normal[(*joint, other)] += product;
            }
            for (other, behind, sign) in &told {
                normal[(*joint, *other)] += side * sign * self.normal[(*at, *behind)];
            }
        }
        // Of a joint whose gap nobody can see nothing is left but rounding.
        let most = normal.diagonal().max().max(f64::MIN_POSITIVE);
        for joint in 0..self.joints {
            normal[(joint, joint)] += LEAST * most;
        }
        let gaps = normal.cholesky().map(|factor| factor.solve(&right));
        let gaps = gaps.unwrap_or_else(|| DVector::zeros(self.joints));
        let explained = right.dot(&gaps);
        (gaps, explained)
    }

    /// The most that gaps move a row by, and how far noise does, in units of its equations.
    pub fn reach(&self, beside: &Beside) -> impl Fn(usize) -> [f64; 2] {
        let none = vec![0; self.heads.len()];
        let (gaps, explained) = self.solved(&none);
        let at = beside.problem.linearise(beside.state);
        let noise = self.noise(explained);
        let joints = self.joints;
        let beside = *beside;
        move |row| {
            let moved = |_: usize, d: &Derivatives| -> Vec<Vector3<f64>> {
                (0..joints).map(|joint| beside.moved(joint, d) * gaps[joint]).collect()
            };
            let e = at.equations_beside(row, &moved);
            let own = e.block.columns(e.block.ncols() - joints, joints);
            [own.column_iter().map(|column| column.norm()).sum(), noise]
        }
    }

    /// Standard deviation of what is left.
    fn noise(&self, explained: f64) -> f64 {
        ((self.square - explained).max(0.0) / self.freedom).sqrt()
    }

    /// The side of each head as far as it is told, stretch by stretch until none changes: none
    /// is believed that is not sure beside all others, and gaps are first those of rows whose
    /// sides are known, so that sides that fit noise make no gap.
    pub fn told(&self) -> Vec<i8> {
        let mut sides = vec![0; self.heads.len()];
        let stretches: BTreeSet<usize> = self.heads.iter().map(|head| head.stretch).collect();
        for _ in 0..ROUNDS {
            let before = sides.clone();
            for stretch in &stretches {
                self.tell(*stretch, &mut sides);
            }
            if sides == before {
                break;
            }
        }
        sides
    }

    /// Tells the sides of the heads of a stretch beside those of all others.
    fn tell(&self, stretch: usize, sides: &mut [i8]) {
        let own: Vec<usize> =
            (0..self.heads.len()).filter(|h| self.heads[*h].stretch == stretch).collect();
        let variance = self.noise(self.solved(sides).1).powi(2).max(f64::MIN_POSITIVE);
        let mut best = vec![[f64::NEG_INFINITY; 2]; own.len()];
        let mut likeliest = (f64::NEG_INFINITY, sides.to_vec());
        for choice in 0..1_usize << own.len() {
            own.iter().enumerate().for_each(|(k, h)| sides[*h] = [1, -1][choice >> k & 1]);
            let (_, explained) = self.solved(sides);
            for (k, best) in best.iter_mut().enumerate() {
                let best = &mut best[choice >> k & 1];
                *best = best.max(explained);
            }
            if explained > likeliest.0 {
                likeliest = (explained, sides.to_vec());
            }
        }
        let (most, likeliest) = likeliest;
        for (h, [up, down]) in own.into_iter().zip(best) {
            let nats = (up - down) / (2.0 * variance);
            // What lies in the middle is on neither side, though on one it is less far off.
            let mut middle = likeliest.clone();
            middle[h] = 0;
            let told = nats.abs() >= SURE && most >= self.solved(&middle).1;
            sides[h] = if told { nats.signum() as i8 } else { 0 };
        }
    }
}
