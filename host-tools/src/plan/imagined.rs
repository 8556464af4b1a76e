//! Measurements that could be made, of a kind: where the nominal arm would have
//! them. What they would tell comes from the observation interface, as the rows of
//! a file do.

use std::path::PathBuf;

use nalgebra::{DMatrix, Rotation3, UnitQuaternion};
use truearm::Pose;

use crate::identify::{Linearised, Problem, Scaling, State};
use crate::model::arm::chain;
use crate::model::{Form, Instrument, KindId, Measurements, Robot, Row};
use crate::observations::{self, kind};

/// Of an angle that nothing is stated of, rad: as in files.
const SIGMA_ANGLE: f64 = 0.01 / 180.0 * std::f64::consts::PI;

/// The rows, and the state that they were imagined at.
pub struct Imagined {
    data: Measurements,
    state: State,
}

impl Imagined {
    /// One row a pose.
    #[must_use]
    pub fn new(robot: &Robot, poses: &[Vec<f64>], id: KindId) -> Self {
        let arm = chain(&robot.nominal(), Pose::identity(), robot.tool);
        let turns = observations::KINDS[usize::from(id.0)].turns();
        let row = |(pose, q): (usize, &Vec<f64>)| {
            let seen = arm.pose(q);
            let mut measured = seen.translation.iter().copied().collect::<Vec<f64>>();
            if turns {
                let turn = Rotation3::from_matrix_unchecked(seen.rotation);
                measured.extend(UnitQuaternion::from_rotation_matrix(&turn).coords.iter());
            }
            Row {
                kind: id,
                measured: measured.into_iter().collect(),
                sigma: robot.sigma,
                sigma_angle: robot.sigma_angle.unwrap_or(SIGMA_ANGLE),
                refers: if turns { vec![0] } else { Vec::new() },
                pose,
                ..Row::at(q.clone())
            }
        };
        let turn = turns.then(|| Instrument::unknown(Form::Turn, ""));
        let data = Measurements {
            path: PathBuf::new(),
            behind: Vec::new(),
            rows: poses.iter().enumerate().map(row).collect(),
            stations: vec![String::new()],
            markers: vec![String::new()],
            known_markers: Vec::new(),
            guessed_markers: Vec::new(),
            instruments: turn.into_iter().collect(),
            base: Pose::identity(),
            poses: poses.len(),
            extra_columns: Vec::new(),
            directions_from_order: false,
            warnings: Vec::new(),
        };
        let state = State {
            bases: vec![Pose::identity()],
            markers: vec![robot.tool],
            instruments: data.instruments.clone(),
            links: robot.nominal(),
            terms: Vec::new(),
        };
        Self { data, state }
    }

    /// The identification that would follow.
    #[must_use]
    pub fn problem(&self, robot: &Robot) -> Problem<'_> {
        Problem::new(&self.data, robot, Scaling::Prior)
    }

    /// Blocks of all rows side by side, transposed: equations in sigmas, unknowns
    /// in tolerances.
    #[must_use]
    pub fn equations(&self, problem: &Problem) -> DMatrix<f64> {
        let width = self.data.rows.first().map_or(0, |row| kind(row).components().len());
        let at = Linearised::new(problem, &self.state);
        self.beside(width, |row| at.equations(row).block)
    }

    /// How the tool point moves at each row, m: three columns a row.
    #[must_use]
    pub fn tool_points(&self, problem: &Problem) -> DMatrix<f64> {
        let at = Linearised::new(problem, &self.state);
        self.beside(3, |row| at.target(row).1)
    }

    fn beside(&self, width: usize, block: impl Fn(usize) -> DMatrix<f64>) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(0, 0);
        for row in 0..self.data.rows.len() {
            let block = block(row);
            if out.is_empty() {
                out = DMatrix::zeros(block.ncols(), width * self.data.rows.len());
            }
            out.columns_mut(width * row, width).copy_from(&block.transpose());
        }
        out
    }
}
