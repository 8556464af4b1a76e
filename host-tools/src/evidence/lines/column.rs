//! What a joint does at every row, and what the waves of an order explain of it.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Sums side by side.
const LANES: usize = 4;
/// Share of a column's square that geometry must leave.
const SEEN: f64 = 1e-4;

/// A joint's geometric column at every row, over sigma and the noise scale.
#[derive(Debug, Clone, Default)]
pub struct JointColumn {
    /// Joint values, rad.
    pub q: Vec<f64>,
    /// Squared length of the column.
    pub square: Vec<f64>,
    /// Its product with the residual, geometry projected out.
    pub right: Vec<f64>,
    /// [`crate::evidence::Geometry::whiten`] of `G_i' c_i`, one column a row.
    pub imitated: DMatrix<f64>,
}

/// Products of a line's cosine and sine, with each other and with the residual, geometry
/// projected out.
pub(super) struct Pair {
    /// Of cos cos, cos sin and sin sin with the squares, of cos and sin with the right sides.
    pub sums: [f64; 5],
    /// What geometry imitates of either, a column each.
    pub imitated: DMatrix<f64>,
}

impl JointColumn {
    /// What cosine and sine of an order explain together, of all rows, where this is left.
    #[must_use]
    pub fn strength(&self, right: &[f64], order: f64) -> f64 {
        self.pair(right, order).strength()
    }

    /// Coefficients of cosine and sine of an order by least squares.
    #[must_use]
    pub fn fitted(&self, order: f64) -> [f64; 2] {
        let ([cc, cs, ss], right) = self.pair(&self.right, order).normal();
        let normal = Matrix2::new(cc, cs, cs, ss);
        normal.lu().solve(&Vector2::from(right)).map_or([0.0; 2], Into::into)
    }

    /// Adds something that the joint does to the residual so many times, less what geometry
    /// imitates of it.
    pub fn move_by(&mut self, moved: &[f64], times: f64) {
        let imitated = &self.imitated * DVector::from_column_slice(moved);
        let imitated = self.imitated.tr_mul(&imitated);
        for (i, right) in self.right.iter_mut().enumerate() {
            *right += times * (self.square[i] * moved[i] - imitated[i]);
        }
    }

    fn pair(&self, right: &[f64], order: f64) -> Pair {
        let waves = Waves::new(&self.q, order, None);
        let mut sums = [0.0; 5];
        waves.add(&self.square, right, &mut sums);
        let mut imitated = DMatrix::zeros(self.imitated.nrows(), 2);
        let (mut cos, mut sin) = imitated.columns_range_pair_mut(0, 1);
        for (i, own) in self.imitated.column_iter().enumerate() {
            cos.axpy(waves.cos[i], &own, 1.0);
            sin.axpy(waves.sin[i], &own, 1.0);
        }
        Pair { sums, imitated }
    }
}

impl Pair {
    fn normal(&self) -> ([f64; 3], [f64; 2]) {
        let [cc, cs, ss, rc, rs] = self.sums;
        let (pc, ps) = (self.imitated.column(0), self.imitated.column(1));
        ([cc - pc.norm_squared(), cs - pc.dot(&ps), ss - ps.norm_squared()], [rc, rs])
    }

    /// What both explain together.
    pub fn strength(&self) -> f64 {
        let [full_c, _, full_s, ..] = self.sums;
        let ([cc, cs, ss], [rc, rs]) = self.normal();
        let determinant = cc * ss - cs * cs;
        // Hardly anything left that geometry cannot imitate: no test.
        if cc <= SEEN * full_c || ss <= SEEN * full_s || determinant <= 1e-6 * cc * ss {
            return 0.0;
        }
        (ss * rc * rc - 2.0 * cs * rc * rs + cc * rs * rs) / determinant
    }
}

/// Cosine and sine of an order at some values; from one order to the next by a rotation, no
/// sine for each.
pub(super) struct Waves {
    pub cos: Vec<f64>,
    pub sin: Vec<f64>,
    step: Vec<(f64, f64)>,
}

impl Waves {
    pub fn new(q: &[f64], first: f64, step: Option<f64>) -> Self {
        let (sin, cos) = q.iter().map(|q| (q * first).sin_cos()).unzip();
        let turn = |step: f64| q.iter().map(|q| (q * step).sin_cos()).collect();
        Self { cos, sin, step: step.map_or_else(Vec::new, turn) }
    }

    pub fn turn(&mut self) {
        let waves = self.cos.iter_mut().zip(&mut self.sin);
        for ((cos, sin), (step_sin, step_cos)) in waves.zip(&self.step) {
            (*sin, *cos) = (*sin * step_cos + *cos * step_sin, *cos * step_cos - *sin * step_sin);
        }
    }

    /// Adds cos cos, cos sin and sin sin times the squares, cos and sin times the right sides:
    /// several sums side by side, as a processor has them.
    pub fn add(&self, square: &[f64], right: &[f64], sums: &mut [f64; 5]) {
        let mut side = [[0.0; LANES]; 5];
        for first in (0..square.len()).step_by(LANES) {
            let count = LANES.min(square.len() - first);
            for lane in 0..count {
                let i = first + lane;
                let (cos, sin) = (self.cos[i], self.sin[i]);
                let (c, s) = (cos * square[i], sin * square[i]);
                let more = [cos * c, cos * s, sin * s, cos * right[i], sin * right[i]];
                side.iter_mut().zip(more).for_each(|(side, more)| side[lane] += more);
            }
        }
        for (sum, side) in sums.iter_mut().zip(side) {
            *sum += side.iter().sum::<f64>();
        }
    }
}
