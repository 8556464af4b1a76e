//! What geometry leaves of each column: ready for lines and steps of unknown place.

use nalgebra::{DVector, Vector3};

use super::follows::Part;
use super::possible::revolute;
use super::sheet::{Along, Sheet, Way, Weights};
use crate::evidence::lines::JointColumn;
use crate::identify::{Problem, State};
use crate::model::arm::Derivatives;
use crate::observations::postures;

/// What a scan is made of.
pub struct Columns<'p> {
    problem: &'p Problem<'p>,
    /// Where the arm stood.
    postures: Vec<usize>,
    /// Revolute joints, counted from 0.
    joints: Vec<usize>,
    /// What moves along each way; none where the base turns about its axes.
    movers: Vec<Option<Part>>,
    along: Along,
}

impl Columns<'_> {
    /// The revolute joints, counted from 0.
    #[must_use]
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// That of a revolute joint, with its values.
    #[must_use]
    pub fn joint(&self, joint: usize) -> JointColumn {
        let rows = &self.problem.data.rows;
        let q = self.postures.iter().map(|row| rows[*row].q[joint]).collect();
        let column = self.ways(Part::Joint(joint)).map(|way| way.column(1)).next();
        JointColumn { q, ..column.unwrap_or_default() }
    }

    /// Each way of a part.
    pub fn ways(&self, part: Part) -> impl Iterator<Item = Way<'_>> {
        self.moved_by(move |mover| mover == Some(part))
    }

    /// The base about and along its axes.
    pub fn base(&self) -> impl Iterator<Item = Way<'_>> {
        self.moved_by(|mover| matches!(mover, None | Some(Part::Shift)))
    }

    fn moved_by(&self, is: impl Fn(Option<Part>) -> bool) -> impl Iterator<Item = Way<'_>> {
        let own = self.movers.iter().enumerate().filter(move |(_, mover)| is(**mover));
        own.map(|(way, _)| Way { along: &self.along, way })
    }
}

/// What moves in a cell beside its revolute joints.
#[must_use]
pub fn cell(problem: &Problem) -> Vec<Option<Part>> {
    let joints = revolute(problem);
    let slides = (0..problem.nominal.len()).filter(|j| !joints.contains(j)).map(Part::Joint);
    let parts = slides.chain(Part::apart(problem, true)).map(Some);
    [Some(Part::Target), None, Some(Part::Shift)].into_iter().chain(parts).collect()
}

/// The revolute joints and others at the rows. A noise scale of 0 is not known yet.
#[must_use]
pub fn columns<'p>(
    problem: &'p Problem<'p>,
    state: &State,
    rows: &[usize],
    weights: &Weights,
    (lambda, scale): (f64, f64),
    others: &[Option<Part>],
) -> Columns<'p> {
    let bare = Sheet::new(problem, state, &[], weights, &[]);
    let gram = bare.gram(rows);
    let precision = bare.precision(lambda);
    let scale = if scale > 0.0 { scale } else { gram.scale_of_geometry(&precision) };
    let geometry = gram.geometry(&precision, scale);
    let joints = revolute(problem);
    let own = joints.iter().map(|joint| Some(Part::Joint(*joint)));
    let all: Vec<Option<Part>> = own.chain(others.iter().copied()).collect();
    let ways = |row: usize, d: &Derivatives| -> Vec<Vector3<f64>> {
        let of = |mover: &Option<Part>| match mover {
            Some(part) => part.moves(problem, row, d),
            None => d.base[..AXES].to_vec(),
        };
        all.iter().flat_map(of).collect()
    };
    let count = |mover: &Option<Part>| mover.map_or(AXES, Part::ways);
    let movers: Vec<Option<Part>> =
        all.iter().flat_map(|mover| std::iter::repeat_n(*mover, count(mover))).collect();
    let mean = geometry.mean(&gram, &DVector::zeros(0));
    let along = bare.along(rows, (movers.len(), &ways), (&geometry, &mean), scale);
    Columns { problem, postures: postures(&problem.data.rows, rows), joints, movers, along }
}

/// Axes that the base turns about.
const AXES: usize = 3;
