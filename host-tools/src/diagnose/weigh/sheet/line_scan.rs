//! What a scan for lines and steps needs.

use nalgebra::{DMatrix, DVector, Dyn, StorageMut, Vector, Vector3};
use rayon::prelude::*;

use super::{Sheet, counted};
use crate::evidence;
use crate::evidence::lines::JointColumn;
use crate::model::Values;
use crate::model::arm::Derivatives;
use crate::observations::postures;

/// How the target of a row moves along each of some ways.
pub type Ways<'w> = dyn Fn(usize, &Derivatives) -> Vec<Vector3<f64>> + Sync + 'w;

/// How the target moves along several ways wherever the arm stood, and what geometry leaves
/// there. What geometry imitates of a way takes a number an unknown and a posture: of all ways
/// it would be most of what a diagnosis of many rows holds, so it is made of the rows when
/// somebody asks for it.
pub struct Along {
    unknowns: usize,
    blocks: Vec<Block>,
}

/// Some postures after each other, equation by equation.
struct Block {
    /// Postures before it.
    before: usize,
    /// Where each posture's equations begin, and where the last one's end.
    first: Vec<usize>,
    /// [`evidence::Geometry::whiten`] of the rows of geometry, an equation a column.
    geometry: DMatrix<f64>,
    /// What the most probable geometry leaves.
    residual: DVector<f64>,
    /// An equation a row, a way a column.
    moved: DMatrix<f64>,
}

impl Along {
    /// Those of geometry.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }
}

impl Block {
    /// Of rows with so many unknowns of geometry and ways, at a noise scale.
    fn of(
        all: &[Row],
        (p, count): (usize, usize),
        geometry: &evidence::Geometry,
        scale: f64,
    ) -> Self {
        let equations = all.iter().map(|row| row.ends * row.residual.len()).sum();
        let mut block = Self {
            before: 0,
            first: vec![0],
            geometry: DMatrix::zeros(p, equations),
            residual: DVector::zeros(equations),
            moved: DMatrix::zeros(equations, count),
        };
        let mut at = 0;
        for (row, end) in all.iter().flat_map(|row| (0..row.ends).map(move |end| (row, end))) {
            let own = row.equations.columns(p + end * count, count);
            for component in 0..row.residual.len() {
                let equation = row.equations.row(component).columns(0, p).transpose();
                block.geometry.set_column(at, &(equation * (row.weight * scale)));
                block.residual[at] = row.residual[component] * (row.weight / scale);
                block.moved.set_row(at, &(own.row(component) * (row.weight / scale)));
                at += 1;
            }
            block.first.push(at);
        }
        block.geometry = geometry.whiten(&block.geometry);
        block
    }

    fn postures(&self) -> usize {
        self.first.len() - 1
    }
}

/// One of them.
#[derive(Clone, Copy)]
pub struct Way<'a> {
    /// With all others.
    pub along: &'a Along,
    /// Its place among them.
    pub way: usize,
}

impl Way<'_> {
    /// At each `every`-th posture, without joint values.
    #[must_use]
    pub fn column(&self, every: usize) -> JointColumn {
        let postures: usize = self.along.blocks.iter().map(Block::postures).sum();
        let looked = postures.div_ceil(every);
        let mut out = JointColumn {
            q: Vec::new(),
            square: Vec::with_capacity(looked),
            right: Vec::with_capacity(looked),
            imitated: DMatrix::zeros(self.along.unknowns, looked),
        };
        let places = (0..postures).step_by(every);
        for (posture, mut imitated) in places.zip(out.imitated.column_iter_mut()) {
            let [square, right] = self.add(posture, &mut imitated);
            out.square.push(square);
            out.right.push(right);
        }
        out
    }

    /// Adds what geometry imitates of it at a posture to a sum, an unknown each: square of the
    /// way and its product with what is left there.
    #[must_use]
    pub fn add<S: StorageMut<f64, Dyn>>(
        &self,
        posture: usize,
        imitated: &mut Vector<f64, Dyn, S>,
    ) -> [f64; 2] {
        let blocks = &self.along.blocks;
        let block = &blocks[blocks.partition_point(|block| block.before <= posture) - 1];
        let place = posture - block.before;
        let (first, count) = (block.first[place], block.first[place + 1] - block.first[place]);
        let moved = block.moved.column(self.way);
        let moved = moved.rows(first, count);
        imitated.gemv(1.0, &block.geometry.columns(first, count), &moved, 1.0);
        [moved.norm_squared(), moved.dot(&block.residual.rows(first, count))]
    }
}

impl Sheet<'_> {
    /// How the target moves along each of `count` ways wherever the arm stood, in the order
    /// of [`postures`], and along it what the most probable geometry, `mean`, leaves (rows may
    /// have other weights than in the last fit, and what geometry imitates must be nothing
    /// by these). All ways in one
    /// pass of the rows, whose equations cost more than the ways. What both ends of a pair
    /// have in common is left to the evidence: of many it is nothing on the average. Readings
    /// of a pose count as in the Gram matrix that `geometry` is of.
    #[must_use]
    pub fn along(
        &self,
        rows: &[usize],
        (count, ways): (usize, &Ways),
        (geometry, mean): (&evidence::Geometry, &DVector<f64>),
        scale: f64,
    ) -> Along {
        let p = self.problem.unknowns.list().len();
        let data = &self.problem.data.rows;
        let counts = counted(self.problem, rows, self.weights.common);
        let one = |(index, counts): (&usize, &f64)| {
            let ends = postures(data, &[*index]);
            let own = |i: usize, d: &Derivatives, end: usize| match i == end {
                true => ways(i, d),
                false => vec![Vector3::zeros(); count],
            };
            let beside = |i: usize, d: &Derivatives| {
                let ways = ends.iter().flat_map(|e| own(i, d, *e));
                ways.chain(self.scattered(*index, i, d)).collect()
            };
            let e = self.at.equations_beside(*index, &beside);
            let explained = e.block.columns(0, p) * mean;
            let residual = Values::from_fn(e.rhs.len(), |c| e.rhs[c] - explained[c]);
            let (equations, residual) = self.beside_scatter(e.block, residual, *index);
            let weight = (self.weights.rows[*index] * counts).sqrt();
            Row { ends: ends.len(), equations, residual, weight }
        };
        let block = |(rows, counts): (&[usize], &[f64])| {
            let all: Vec<Row> = rows.iter().zip(counts).map(one).collect();
            Block::of(&all, (p, count), geometry, scale)
        };
        let blocks = rows.par_chunks(ROWS).zip(counts.par_chunks(ROWS)).map(block);
        let mut blocks: Vec<Block> = blocks.collect();
        let mut before = 0;
        for block in &mut blocks {
            block.before = before;
            before += block.postures();
        }
        Along { unknowns: p, blocks }
    }
}

/// Rows of a block.
const ROWS: usize = 512;

/// The equations of a row, the ways of each of its ends behind those of geometry.
struct Row {
    ends: usize,
    equations: DMatrix<f64>,
    residual: Values,
    weight: f64,
}
