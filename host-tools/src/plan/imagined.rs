//! Measurements that could be made, of a kind: where the nominal arm would have
//! them. What they would tell comes from the observation interface, as the rows of
//! a file do.

use std::ops::Range;
use std::path::PathBuf;

use nalgebra::{DMatrix, Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::kinds::Candidate;
use crate::error::{Error, ErrorKind, Result};
use crate::files::{Gathered, USUAL_SIGMA_ANGLE, USUAL_SIGMA_PX};
use crate::identify::{Linearised, Problem, Scaling, State};
use crate::model::arm::chain;
use crate::model::{Form, KindId, Measurements, PlannedRow, Robot, Row, Values};
use crate::observations::{ArmPart, Body, KINDS, Kind, Partials, Told, equations_of, kind};

/// The rows, and the state that they were imagined at.
pub struct Imagined {
    data: Measurements,
    state: State,
    /// Which rows each measurement is.
    spans: Vec<Range<usize>>,
}

/// What is to be known: where it is, and how it moves.
pub struct Motions {
    /// What it is, in words.
    pub what: &'static str,
    /// Three columns a pose, m; a row an unknown.
    pub moved: DMatrix<f64>,
}

impl Imagined {
    /// With what is stated of instruments.
    ///
    /// # Errors
    /// Labels that mean nothing there.
    pub fn new(
        robot: &Robot,
        candidates: &[Candidate],
        id: KindId,
        book: &Gathered,
    ) -> Result<Self> {
        let of = KINDS[usize::from(id.0)];
        let mut book = book.clone();
        let (mut rows, mut spans): (Vec<Row>, _) = (Vec::new(), Vec::new());
        for candidate in candidates {
            let first = rows.len();
            for planned in candidate {
                let mut row = row(robot, (id, of), planned, &mut book)?;
                row.pose = rows.len();
                row.partner = (of.joined_by().is_some() && rows.len() > first).then_some(first);
                rows.push(row);
            }
            spans.push(first..rows.len());
        }
        let mut data = Measurements {
            path: PathBuf::new(),
            behind: Vec::new(),
            poses: rows.len(),
            rows,
            stations: vec![String::new()],
            markers: vec![of.target("").into_owned()],
            known_markers: Vec::new(),
            guessed_markers: Vec::new(),
            instruments: Vec::new(),
            base: robot.base.pose(),
            extra_columns: Vec::new(),
            directions_from_order: false,
            order_from_rows: false,
            sides_found: Vec::new(),
            warnings: Vec::new(),
        };
        book.hand_over(&mut data, robot);
        let stated = [&data.known_markers, &data.guessed_markers].map(|all| all[0]);
        let state = State {
            bases: vec![data.base],
            markers: vec![stated[0].or(stated[1]).unwrap_or(robot.tool)],
            instruments: data.instruments.clone(),
            links: robot.nominal(),
            terms: Vec::new(),
        };
        let mut imagined = Self { data, state, spans };
        imagined.read(robot);
        Ok(imagined)
    }

    /// Writes what the nominal arm would have read.
    fn read(&mut self, robot: &Robot) {
        let arm = self.state.chain(0, 0);
        for row in self.data.rows.iter_mut().filter(|row| is_turned(row)) {
            let seen = arm.pose(&row.q).compose(&self.state.instruments[row.refers[0]].place);
            let turn = Rotation3::from_matrix_unchecked(seen.rotation);
            let turn = UnitQuaternion::from_rotation_matrix(&turn);
            row.measured = seen.translation.iter().chain(turn.coords.iter()).copied().collect();
        }
        let problem = self.problem(robot);
        let at = Linearised::new(&problem, &self.state);
        let off: Vec<_> = (0..self.data.rows.len()).map(|row| at.residual(row)).collect();
        for (row, off) in self.data.rows.iter_mut().zip(off) {
            // Of a turn it is nothing already.
            let columns = if is_turned(row) { 0 } else { kind(row).columns().len() };
            (0..columns.min(off.len())).for_each(|c| row.measured[c] -= off[c]);
        }
    }

    /// The rows.
    #[must_use]
    pub fn data(&self) -> &Measurements {
        &self.data
    }

    /// Equations of the measurement that gives the fewest.
    #[must_use]
    pub fn fewest_equations(&self) -> usize {
        let of = |span: &Range<usize>| self.data.rows[span.clone()].iter().map(equations_of).sum();
        self.spans.iter().map(of).min().unwrap_or(0)
    }

    /// Where they were imagined at.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The identification that would follow.
    #[must_use]
    pub fn problem(&self, robot: &Robot) -> Problem<'_> {
        Problem::new(&self.data, robot, Scaling::Prior)
    }

    /// Blocks of all measurements side by side, transposed: equations in sigmas,
    /// unknowns in tolerances; and how many columns each has. Of one with more equations
    /// than a pose has freedoms, as many as say the same.
    #[must_use]
    pub fn equations(&self, problem: &Problem) -> (DMatrix<f64>, usize) {
        let at = Linearised::new(problem, &self.state);
        let block = |span: &Range<usize>| {
            let rows = span.clone().filter(|row| equations_of(&self.data.rows[*row]) > 0);
            let blocks: Vec<_> = rows.map(|row| at.equations(row).block).collect();
            let all: Vec<_> = blocks.iter().flat_map(|block| block.row_iter()).collect();
            shortened(DMatrix::from_rows(&all).transpose())
        };
        let blocks: Vec<_> = self.spans.iter().map(block).collect();
        let width = blocks.iter().map(DMatrix::ncols).max().unwrap_or(0);
        let mut out = DMatrix::zeros(problem.unknowns.list().len(), width * blocks.len());
        for (k, block) in blocks.iter().enumerate() {
            out.columns_mut(width * k, block.ncols()).copy_from(block);
        }
        (out, width)
    }

    /// How the tool point moves at other poses of the arm; of a kind that says nothing
    /// of it the place of what measures. Where no point is measured, where the whole arm
    /// stands is nobody's to know: the rigid motion of all poses together is taken out.
    #[must_use]
    pub fn motions(&self, robot: &Robot, problem: &Problem, poses: &[Vec<f64>]) -> Motions {
        let like = &self.data.rows[0];
        let rows = poses.iter().map(|q| Row { q: q.clone(), partner: None, ..like.clone() });
        let data = Measurements { rows: rows.collect(), ..self.data.clone() };
        let there = Problem::new(&data, robot, Scaling::Prior);
        let there = Problem { unknowns: problem.unknowns.clone(), ..there };
        let camera = self.camera(problem);
        let mut state = self.state.clone();
        if let Some(camera) = camera {
            state.markers[0] = state.instruments[camera].place.translation;
        }
        let at = Linearised::new(&there, &state);
        let arm = chain(&state.links, state.bases[0], state.markers[0]);
        let mut points = Vec::with_capacity(poses.len());
        let mut moved = DMatrix::zeros(problem.unknowns.list().len(), 3 * poses.len());
        for (k, q) in poses.iter().enumerate() {
            let seen = arm.pose(q);
            let block = match camera {
                Some(camera) => at.block(&self.centre(k, camera, &seen.rotation)),
                None => at.target(k).1,
            };
            points.push(seen.translation);
            moved.columns_mut(3 * k, 3).copy_from(&block.transpose());
        }
        let what = match camera {
            Some(_) => "the camera",
            None if self.data.markers[0].is_empty() => "the tool point",
            None => "the origin of the ray",
        };
        if kind(like).point(like).is_none() {
            moved = without_rigid(&moved, &points);
        }
        Motions { what, moved }
    }

    /// The camera in hand where no row depends on the marker.
    fn camera(&self, problem: &Problem) -> Option<usize> {
        let in_hand = |i: &crate::model::Instrument| i.form == Form::Camera && i.on_flange;
        let camera = self.state.instruments.iter().position(in_hand);
        camera.filter(|_| problem.unknowns.marker(0).is_none())
    }

    /// How the centre of a camera moves with the last frame and on it.
    fn centre(&self, row: usize, camera: usize, turned: &Matrix3<f64>) -> Partials {
        let of = &self.state.instruments[camera];
        let mut pull = DMatrix::zeros(3, 6);
        pull.view_mut((0, 0), (3, 3)).fill_with_identity();
        let mut own = DMatrix::zeros(3, of.free.len());
        own.view_mut((0, 3), (3, 3)).copy_from(&(turned * of.place.rotation));
        let arm = vec![ArmPart { row, body: Body::Target, pull }];
        Partials { residual: Values::default(), arm, instruments: vec![(camera, own)] }
    }
}

fn row(
    robot: &Robot,
    (id, of): (KindId, &dyn Kind),
    planned: &PlannedRow,
    book: &mut Gathered,
) -> Result<Row> {
    let text = |name: &str| {
        let label = planned.labels.iter().find(|(column, _)| *column == name);
        label.map_or("", |(_, label)| label.as_str())
    };
    let target = of.target("");
    let bound = of.bind(&Told { marker: &target, text: &text }, book);
    let bound =
        bound.map_err(|(_, message, help)| Error::data(ErrorKind::NoPoses, message, help))?;
    let zeros = std::iter::repeat_n(0.0, of.columns().len());
    Ok(Row {
        kind: id,
        measured: zeros.chain(bound.known).collect(),
        sigma: robot.sigma,
        sigma_angle: robot.sigma_angle.unwrap_or(USUAL_SIGMA_ANGLE),
        sigma_px: USUAL_SIGMA_PX,
        refers: bound.refers,
        ..Row::at(planned.q.clone())
    })
}

/// Whether it measures a point and how the frame there is turned.
fn is_turned(row: &Row) -> bool {
    kind(row).turns() && kind(row).point(row).is_some()
}

/// Equations of one measurement, a column each: as few as say the same. By Householder's
/// reflections alone: a singular value decomposition of what has many exact zeros came out
/// with directions that no equation has, one candidate in some thousands.
fn shortened(block: DMatrix<f64>) -> DMatrix<f64> {
    const FEW: usize = 6;
    const ROUNDING: f64 = 1e-9;
    if block.ncols() <= FEW {
        return block;
    }
    // Block = Q R, and R R' = L L' with L as narrow as the rank.
    let (q, r, _) = block.col_piv_qr().unpack();
    let largest = r[(0, 0)].abs();
    let told = (0..r.nrows()).take_while(|k| r[(*k, *k)].abs() > ROUNDING * largest).count();
    let narrow = r.rows(0, told).transpose().qr().r().transpose();
    q.columns(0, told) * narrow
}

/// What no rigid motion of all points explains of their motions.
fn without_rigid(moved: &DMatrix<f64>, points: &[Vector3<f64>]) -> DMatrix<f64> {
    let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let mut rigid = DMatrix::zeros(6, 3 * points.len());
    for (k, point) in points.iter().enumerate() {
        rigid.view_mut((0, 3 * k), (3, 3)).fill_with_identity();
        // Transposed: how a turn about the middle moves the point.
        rigid.view_mut((3, 3 * k), (3, 3)).copy_from(&(point - middle).cross_matrix());
    }
    let gram = &rigid * rigid.transpose();
    let pull = moved * rigid.transpose();
    let Ok(inverse) = gram.pseudo_inverse(1e-9) else { return moved.clone() };
    moved - pull * inverse * rigid
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// As images of a board: many equations of six freedoms, unknowns that move nothing. The
    /// same information, to rounding, whatever the draw.
    #[test]
    fn shortened_equations_say_the_same() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for draw in 0..3000 {
            let (unknowns, equations) = (42, rng.random_range(7..50));
            let freedoms = rng.random_range(1..=6);
            let mut any = |n, m| DMatrix::from_fn(n, m, |_, _| rng.random_range(-1.0..1.0));
            let mut moved = any(unknowns, freedoms);
            (0..12).for_each(|k| moved.row_mut(3 * k).fill(0.0));
            let block = moved * any(freedoms, equations);
            let short = shortened(block.clone());
            assert!(short.ncols() <= freedoms, "{draw}: {} of {freedoms}", short.ncols());
            let (all, few) = (&block * block.transpose(), &short * short.transpose());
            assert!((&all - few).amax() < 1e-13 * all.amax(), "{draw}");
        }
    }
}
