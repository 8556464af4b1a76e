//! The covariance that a blob carries: of base, tool point, links and terms in
//! the commanded frame, tracker and other reflectors marginalised away.

use nalgebra::{DMatrix, Matrix3, Matrix3x6, Matrix6, Matrix6xX, Vector3};
use truearm::Pose;
use truearm::blob::uncertain_parameters;

use crate::identify::problem::accumulate::{CHUNK, tree};
use crate::identify::problem::{Problem, State, Unknowns};
use crate::identify::start::{on_a_line, tool};
use crate::model::arm::{Derivatives, Kinematics, RowInputs, chain};
use crate::model::{Instrument, ModelTerm, Row};

/// Covariance of the parameters in the order of a blob, SI, from that of all
/// unknowns. The small base between identified and commanded frame is no
/// unknown: it is the rigid fit of identified to nominal tool points over the
/// poses of `rows`, so its errors follow from theirs, here to first order. The
/// nominal points, nominal links with the tool point of the blob, are what the
/// commanded frame is defined by, and have no error.
#[must_use]
pub fn of_arm(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    unknowns: &DMatrix<f64>,
    frame: &Pose<f64>,
) -> DMatrix<f64> {
    let marker = tool::of(problem.data);
    of_arm_by(problem, state, &FrameSums::of(problem, state, rows, frame), marker, unknowns)
}

/// The same by what the rows say of the frame, of the marker that stands for the tool.
#[must_use]
pub fn of_arm_by(
    problem: &Problem,
    state: &State,
    frame: &FrameSums,
    marker: Option<usize>,
    unknowns: &DMatrix<f64>,
) -> DMatrix<f64> {
    let columns = &problem.unknowns;
    let joints = state.links.len();
    let is_arm = |t: &ModelTerm| matches!(t, ModelTerm::Arm(_));
    let terms = state.terms.iter().filter(|t| is_arm(t)).count();

    let mut map = DMatrix::zeros(uncertain_parameters(joints, terms), columns.list().len());
    map.rows_mut(0, 6).copy_from(&frame.base());
    let marker = marker.and_then(|marker| columns.marker(marker));
    for (k, column) in (0..3).zip(marker.into_iter().flat_map(|first| first..)) {
        map[(6 + k, column)] = 1.0;
    }
    for k in 0..5 * joints {
        map[(9 + k, columns.free() + k)] = 1.0;
    }
    let estimated = state.terms.iter().zip(columns.terms()).filter(|(t, _)| is_arm(t));
    for (k, (_, column)) in estimated.enumerate() {
        map[(9 + 5 * joints + k, column)] = 1.0;
    }
    &map * unknowns * map.transpose()
}

/// What some rows say of the frame between identified and nominal tool points: the sums of
/// its least-squares problem, in how it moves with every unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSums {
    /// Normal matrix of translation and rotation.
    pub normal: Matrix6<f64>,
    /// Its right-hand side, a column an unknown in SI.
    pub pull: Matrix6xX<f64>,
}

impl FrameSums {
    /// Of these rows, by the frame of the state.
    #[must_use]
    pub fn of(problem: &Problem, state: &State, rows: &[usize], frame: &Pose<f64>) -> Self {
        let columns = &problem.unknowns;
        let arms: Vec<Box<dyn Kinematics>> =
            state.markers.iter().map(|m| chain(&state.links, *frame, *m)).collect();
        let leaf = |rows: &[usize]| {
            let mut sums = Self::none(columns.list().len());
            for row in rows.iter().map(|r| &problem.data.rows[*r]) {
                let real = arms[row.marker].derivatives(&row.q, &[], &RowInputs::default());
                sums.add(columns, row, &real);
            }
            sums
        };
        tree(rows, CHUNK, &leaf, &|a, b| a.plus(&b))
    }

    /// Of no rows.
    #[must_use]
    pub fn none(unknowns: usize) -> Self {
        Self { normal: Matrix6::zeros(), pull: Matrix6xX::zeros(unknowns) }
    }

    /// With a row, by derivatives of the arm in that frame.
    pub fn add(&mut self, unknowns: &Unknowns, row: &Row, real: &Derivatives) {
        let [rx, ry, rz, tx, ty, tz] = real.base;
        let motion = Matrix3x6::from_columns(&[tx, ty, tz, rx, ry, rz]).transpose();
        self.normal += motion * motion.transpose();
        let mut add = |column: usize, change: &Vector3<f64>| {
            let mut sum = self.pull.column_mut(column);
            sum -= motion * change;
        };
        for (i, link) in real.links.iter().enumerate() {
            for (k, change) in link.to_array().iter().enumerate() {
                add(unknowns.free() + 5 * i + k, change);
            }
        }
        let marker = unknowns.marker(row.marker).into_iter().flat_map(|m| m..);
        marker.zip(&real.tool).for_each(|(column, change)| add(column, change));
    }

    /// Both together.
    #[must_use]
    pub fn plus(self, other: &Self) -> Self {
        Self { normal: self.normal + other.normal, pull: self.pull + &other.pull }
    }

    /// Change of the base, translation then rotation, with every unknown.
    fn base(&self) -> Matrix6xX<f64> {
        match self.normal.cholesky().filter(|_| !self.on_a_line()) {
            Some(normal) => normal.solve(&self.pull),
            // The frame is then the nominal one, and exact.
            None => &self.pull * 0.0,
        }
    }

    /// Whether the points lie on a line: by the moments of inertia about their middle, which
    /// the rotations of the normal matrix are once translations have followed.
    fn on_a_line(&self) -> bool {
        let block = |i, j| self.normal.fixed_view::<3, 3>(i, j).into_owned();
        let inertia = block(3, 3) - block(3, 0) * block(0, 3) / self.normal[(0, 0)];
        let moments = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
        on_a_line(&moments, 0.5 * block(3, 3).trace())
    }
}

/// The lower triangle L of a covariance `L L'`, column by column, as a blob
/// holds it. The covariance may be singular.
#[must_use]
pub fn factor(covariance: &DMatrix<f64>) -> Vec<f32> {
    let size = covariance.nrows();
    // Rows of one size, or rounding in metres drowns radians per newton metre.
    let scale = covariance.diagonal().map(|v| if v > 0.0 { v.sqrt() } else { 1.0 });
    let scaled = DMatrix::from_fn(size, size, |i, j| covariance[(i, j)] / scale[i] / scale[j]);
    let eigen = scaled.symmetric_eigen();
    let root = eigen.eigenvalues.map(|e| e.max(0.0).sqrt());
    // C = W W' with W = V sqrt(e); W' = Q R gives C = R' R.
    let r = (DMatrix::from_diagonal(&root) * eigen.eigenvectors.transpose()).qr().r();
    let mut out = Vec::with_capacity(size * (size + 1) / 2);
    for j in 0..size {
        let sign = if r[(j, j)] < 0.0 { -1.0 } else { 1.0 };
        out.extend((j..size).map(|i| (sign * r[(j, i)] * scale[i]) as f32));
    }
    out
}

/// Instruments of a state, and how well they were found, from the covariance of all
/// unknowns, SI.
#[must_use]
pub fn instruments(problem: &Problem, state: &State, covariance: &DMatrix<f64>) -> Vec<Instrument> {
    let found = |(i, instrument): (usize, &Instrument)| {
        let own: Vec<usize> = problem.unknowns.instrument(i).map(|(column, _)| column).collect();
        let entry = |a: usize, b: usize| covariance[(own[a], own[b])];
        match own.is_empty() {
            true => instrument.clone(),
            false => instrument.found_within(&DMatrix::from_fn(own.len(), own.len(), entry)),
        }
    };
    state.instruments.iter().enumerate().map(found).collect()
}
