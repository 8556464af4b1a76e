//! A problem at a state: residuals and equations of its rows, and their sums.

use nalgebra::{DMatrix, DVector, Vector3};

use super::Problem;
use super::accumulate::{CHUNK, tree};
use super::motion::{Beside, Motion};
use super::predictor::{Model, View};
use super::unknowns::State;
use crate::model::Values;
use crate::observations::{ArmPart, Body, Moving, Partials, Residual, Seen, kind};
use crate::tikhonov::{Normal, Triangle};

/// A row's equations, scaled: `block x = rhs`.
pub struct Equations {
    /// As many rows as the row's kind has components; a column an unknown, in
    /// units, then those asked for beside them, in SI.
    pub block: DMatrix<f64>,
    /// Right-hand side: residual plus what the current corrections explain, so
    /// that the penalised unknowns are counted from nominal.
    pub rhs: Values,
    /// Measured minus modelled, SI.
    pub residual: Residual,
    /// SI to one unit of each equation.
    pub scale: Values,
}

impl Equations {
    /// The residual in units of the equations.
    #[must_use]
    pub fn scaled_residual(&self) -> Values {
        self.scaled(&self.residual)
    }

    /// A residual of the row in units of its equations.
    #[must_use]
    pub fn scaled(&self, residual: &Residual) -> Values {
        residual.values().zip_map(&self.scale, |r, scale| r / scale)
    }
}

/// A problem at a state.
pub struct Linearised<'a> {
    problem: Problem<'a>,
    model: Model,
    corrections: DVector<f64>,
    units: DVector<f64>,
}

impl<'a> Problem<'a> {
    /// Linearises at a state; its terms are held unless the problem has as many.
    #[must_use]
    pub fn linearise(&self, state: &State) -> Linearised<'a> {
        Linearised::new(self, state)
    }
}

impl<'a> Linearised<'a> {
    /// Of a problem; the state's terms are held unless the problem has as many.
    #[must_use]
    pub fn new(problem: &Problem<'a>, state: &State) -> Self {
        Self {
            model: Model::new(state),
            corrections: problem.corrections(state),
            units: problem.units(),
            problem: problem.clone(),
        }
    }

    /// The same about the state itself: right-hand sides are residuals alone, and the solution
    /// is a step. Where a fit has nearly settled nothing is then lost to rounding.
    #[must_use]
    pub fn about_here(mut self) -> Self {
        self.corrections.fill(0.0);
        self
    }

    fn view(&self) -> View<'_> {
        let Problem { data, conditions, .. } = &self.problem;
        View { model: &self.model, data, conditions }
    }

    fn motion<'l>(&'l self, beside: &'l Beside<'l>) -> Motion<'l> {
        Motion { problem: &self.problem, model: &self.model, units: &self.units, beside }
    }

    /// Measured minus modelled of a row, and minus what was set aside, SI.
    #[must_use]
    pub fn residual(&self, row: usize) -> Residual {
        let residual = Residual::of(row, &self.view());
        if self.problem.aside.is_empty() {
            return residual;
        }
        residual.with(self.beside_aside(row, *residual.values()))
    }

    fn beside_aside(&self, row: usize, residual: Values) -> Values {
        match self.problem.aside.get(row) {
            Some(aside) if aside.len() == residual.len() => {
                residual.zip_map(aside, |r, aside| r - aside)
            }
            _ => residual,
        }
    }

    /// The same in units of the row's equations.
    #[must_use]
    pub fn scaled_residual(&self, row: usize) -> Values {
        self.residual(row).values().zip_map(&self.problem.scale(row), |r, scale| r / scale)
    }

    /// The equations of a row.
    #[must_use]
    pub fn equations(&self, index: usize) -> Equations {
        self.equations_beside(index, &|_, _| Vec::new())
    }

    /// The same with columns beside those of the unknowns.
    #[must_use]
    pub fn equations_beside(&self, index: usize, beside: &Beside) -> Equations {
        let row = &self.problem.data.rows[index];
        let motion = self.motion(beside);
        let (residual, mut block) = kind(row).linearised(index, &motion);
        let residual = self.beside_aside(index, residual);
        let scale = self.problem.scale(index);
        for column in block.as_mut_slice().chunks_exact_mut(scale.len().max(1)) {
            column.iter_mut().zip(scale.iter()).for_each(|(value, scale)| *value /= scale);
        }
        let explained = block.columns(0, self.units.len()) * &self.corrections;
        let rhs = Values::from_fn(scale.len(), |c| residual[c] / scale[c] + explained[c]);
        Equations { block, rhs, residual: Residual::new(row, residual), scale }
    }

    /// Where the target of a row is seen, m, and how it moves with each unknown
    /// in its unit, m: 3 x unknowns.
    #[must_use]
    pub fn target(&self, index: usize) -> (Vector3<f64>, DMatrix<f64>) {
        self.motion(&|_, _| Vec::new()).moved(index)
    }

    /// How the target of a row moves with each unknown in its unit, and with what is asked
    /// for beside them in SI, m: 3 x columns.
    #[must_use]
    pub fn target_beside(&self, index: usize, beside: &Beside) -> DMatrix<f64> {
        self.motion(beside).moved(index).1
    }

    /// How something with these partial derivatives moves with each unknown in its
    /// unit, SI.
    #[must_use]
    pub fn block(&self, partials: &Partials) -> DMatrix<f64> {
        self.motion(&|_, _| Vec::new()).block(partials)
    }

    /// How the frame of what a row measures with is turned by each unknown in its
    /// unit, rad: that of its marker or camera where it has one, else the last.
    #[must_use]
    pub fn turn(&self, index: usize) -> DMatrix<f64> {
        let motion = self.motion(&|_, _| Vec::new());
        let row = motion.row(index);
        let mut pull = DMatrix::zeros(3, 6);
        pull.view_mut((0, 3), (3, 3)).fill_with_identity();
        let mut instruments = Vec::new();
        let mounted = |i: &&usize| motion.instrument(**i).on_flange;
        if let Some(mount) = row.refers.iter().find(mounted) {
            let instrument = motion.instrument(*mount);
            let axes = motion.pose(index).rotation * instrument.place.rotation;
            let mut own = DMatrix::zeros(3, instrument.free.len());
            own.view_mut((0, 0), (3, 3)).copy_from(&axes);
            instruments.push((*mount, own));
        }
        let arm = vec![ArmPart { row: index, body: Body::Target, pull }];
        motion.block(&Partials { residual: Values::default(), arm, instruments })
    }

    /// Equations of the given rows, each multiplied by the root of its weight: a
    /// column `[a; b]` an equation, so that one is written in one piece. For a
    /// chunk of them: [`Linearised::normal`] and [`Linearised::triangle`] are of
    /// any number.
    #[must_use]
    pub fn columns(&self, rows: &[usize], weights: Option<&[Values]>) -> DMatrix<f64> {
        let height = self.units.len() + 1;
        let motion = self.motion(&|_, _| Vec::new());
        let mut matrix = DMatrix::zeros(height, self.problem.equations(rows));
        let mut rest = matrix.as_mut_slice();
        for index in rows {
            let row = &self.problem.data.rows[*index];
            let (residual, block) = kind(row).linearised(*index, &motion);
            let residual = self.beside_aside(*index, residual);
            let scale = self.problem.scale(*index);
            let root = |c: usize| weights.map_or(1.0, |weights| weights[*index][c].sqrt());
            let factor = Values::from_fn(scale.len(), |c| root(c) / scale[c]);
            let (own, others) = rest.split_at_mut(height * scale.len());
            let mut rhs = residual.zip_map(&factor, |r, factor| r * factor);
            // All of a row at once: sums of one equation alone wait for each other.
            let derivatives = block.as_slice().chunks_exact(scale.len().max(1));
            for (k, (moved, x)) in derivatives.zip(self.corrections.as_slice()).enumerate() {
                for (c, moved) in moved.iter().enumerate() {
                    let value = moved * factor[c];
                    own[c * height + k] = value;
                    rhs[c] += value * x;
                }
            }
            (0..scale.len()).for_each(|c| own[(c + 1) * height - 1] = rhs[c]);
            rest = others;
        }
        matrix
    }

    /// `[A, b]` of the same.
    #[must_use]
    pub fn rows(&self, rows: &[usize], weights: Option<&[Values]>) -> DMatrix<f64> {
        self.columns(rows, weights).transpose()
    }

    /// Normal equations of the same, chunk by chunk.
    #[must_use]
    pub fn normal(&self, rows: &[usize], weights: Option<&[Values]>) -> Normal {
        let leaf = |chunk: &[usize]| Normal::of_columns(&self.columns(chunk, weights));
        tree(rows, CHUNK, &leaf, &|a: Normal, b| a.plus(&b))
    }

    /// Triangle of the same, chunk by chunk.
    #[must_use]
    pub fn triangle(&self, rows: &[usize], weights: Option<&[Values]>) -> Triangle {
        let leaf = |chunk: &[usize]| Triangle::new(&self.rows(chunk, weights));
        // Large chunks for many unknowns: two triangles joined cost as much as
        // twice as many rows as there are unknowns.
        let size = CHUNK.max(2 * self.units.len());
        tree(rows, size, &leaf, &|a, b| Triangle::join([&a, &b].into_iter()))
    }

    /// Corrections at this state, in units.
    #[must_use]
    pub fn corrections(&self) -> &DVector<f64> {
        &self.corrections
    }

    /// From units to m and rad.
    #[must_use]
    pub fn to_si(&self, x: &DVector<f64>) -> DVector<f64> {
        x.component_mul(&self.units)
    }
}
