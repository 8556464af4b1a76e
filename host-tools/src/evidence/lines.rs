//! Lines, periodic errors of unknown order: every order is tried alone at a
//! joint, in O(n (p + 2) K) and without a matrix of all orders; the best and
//! their neighbours become candidates.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Below lies eccentricity, and what a limited range of a joint cannot tell
/// from geometry. Cycles a turn.
pub const LOWEST: f64 = 2.6;
/// Orders tried in one matrix product.
const BATCH: usize = 64;
/// Rows that are taken together.
const ROWS: usize = 256;
/// Sums side by side.
const LANES: usize = 4;
/// So many rows say as well as all what geometry imitates of an order...
const LOOKS: usize = 3000;
/// ...up to this share of its squares, to rank orders by: a line that geometry does four fifths
/// of was lost beyond it...
const IMITATED: f64 = 0.05;
/// ...of so many times as many as are asked for it is summed over all.
const AGAIN: usize = 4;
/// Share of a column's square that geometry must leave.
const SEEN: f64 = 1e-4;
/// Lines closer than this in steps of the grid are one line.
const APART: f64 = 2.0;
/// Neighbours of a peak that become candidates, in steps of the grid.
const NEIGHBOURS: [f64; 5] = [0.0, -0.5, 0.5, -1.0, 1.0];

/// A joint's geometric column at every row, over sigma and the noise scale.
#[derive(Debug, Clone, Default)]
pub struct JointColumn {
    /// Joint values, rad.
    pub q: Vec<f64>,
    /// Squared length of the column.
    pub square: Vec<f64>,
    /// Its product with the residual, geometry projected out.
    pub right: Vec<f64>,
    /// [`super::Geometry::whiten`] of `G_i' c_i`, one column a row.
    pub imitated: DMatrix<f64>,
}

/// Products of a line's cosine and sine, with each other and with the residual, geometry
/// projected out.
struct Pair {
    /// Of cos cos, cos sin and sin sin with the squares, of cos and sin with the right sides.
    sums: [f64; 5],
    /// What geometry imitates of either, a column each.
    imitated: DMatrix<f64>,
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

    fn strength(&self) -> f64 {
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

/// Orders that are tried at a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orders {
    /// Distance, cycles a turn: the phase slips by half a radian from one to
    /// the next at either end of the joint's range.
    pub step: f64,
    /// How many.
    pub count: usize,
    /// Whole numbers among those covered.
    pub whole: usize,
}

/// An order that stands out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Cycles a turn.
    pub order: f64,
    /// What it alone would explain of the squares, in units of the noise.
    pub strength: f64,
}

impl Orders {
    /// For a joint that moved over these values, up to `highest` cycles a turn.
    #[must_use]
    pub fn of(q: &[f64], highest: f64) -> Self {
        let low = q.iter().copied().fold(f64::INFINITY, f64::min);
        let high = q.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let step = (1.0 / (high - low).max(1e-3)).clamp(0.05, 0.5);
        let count = ((highest - LOWEST) / step).max(1.0) as usize;
        let whole = (highest.floor() - LOWEST.floor()).max(0.0) as usize;
        Self { step, count, whole }
    }

    fn order(&self, k: usize) -> f64 {
        LOWEST + self.step * k as f64
    }

    /// The `most` strongest lines, strongest first, no two nearer than the data
    /// can tell apart.
    #[must_use]
    pub fn lines(&self, column: &JointColumn, most: usize) -> Vec<Line> {
        self.lines_by(&Scan::new(column, column.q.len().div_ceil(LOOKS).max(1)), most)
    }

    fn lines_by(&self, scan: &Scan, most: usize) -> Vec<Line> {
        let mut found: Vec<Line> = Vec::with_capacity(self.count);
        for first in (0..self.count).step_by(BATCH) {
            let batch = BATCH.min(self.count - first);
            let strengths = scan.strengths(self.order(first), self.step, batch);
            let line = |(k, strength)| Line { order: self.order(first + k), strength };
            found.extend(strengths.into_iter().enumerate().map(line));
        }
        let at = |i: usize| found.get(i).map_or(0.0, |l| l.strength);
        let peak = |i: &usize| at(*i) >= at(i + 1) && (*i == 0 || at(*i) > at(i - 1));
        let mut peaks: Vec<Line> =
            (0..found.len()).filter(peak).map(|i| found[i]).filter(|l| l.strength > 0.0).collect();
        let strongest = |peaks: &mut Vec<Line>| {
            peaks.sort_by(|a, b| {
                b.strength.total_cmp(&a.strength).then(a.order.total_cmp(&b.order))
            });
        };
        strongest(&mut peaks);
        if scan.every > 1 {
            peaks.truncate(AGAIN * most);
            for line in &mut peaks {
                line.strength = scan.column.strength(&scan.column.right, line.order);
            }
            strongest(&mut peaks);
        }
        let mut out: Vec<Line> = Vec::new();
        for line in peaks {
            let near = |l: &Line| (l.order - line.order).abs() < APART * self.step;
            if !out.iter().any(near) {
                out.push(line);
            }
            if out.len() == most {
                break;
            }
        }
        out
    }

    /// Orders that a line may have: the peak, its neighbours at half steps and
    /// the whole numbers among them.
    #[must_use]
    pub fn variants(&self, line: &Line) -> Vec<f64> {
        let mut out: Vec<f64> = NEIGHBOURS.iter().map(|k| line.order + k * self.step).collect();
        let low = (line.order - self.step).ceil() as i64;
        let high = (line.order + self.step).floor() as i64;
        out.extend((low..=high).map(|k| k as f64));
        out.retain(|order| *order > 0.0);
        out.sort_by(f64::total_cmp);
        out.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        out
    }

    /// Orders that are tried.
    #[must_use]
    pub fn range(&self) -> std::ops::RangeInclusive<f64> {
        LOWEST..=self.order(self.count)
    }

    /// Logarithm of the prior odds of a variant at one of `joints` joints.
    #[must_use]
    pub fn log_odds(&self, joints: usize, order: f64) -> f64 {
        let is_whole = (order - order.round()).abs() < 1e-9;
        // Half steps: twice as many orders as were tried.
        super::prior::line_log_odds(joints, 2 * self.count, self.whole, is_whole)
    }
}

/// A column ready for many orders.
struct Scan<'c> {
    column: &'c JointColumn,
    /// What geometry imitates is summed over each so many-th row, which stands for the others:
    /// of thousands of rows it is little, and takes most of the time.
    every: usize,
    /// Of those rows, one row a row.
    imitated: DMatrix<f64>,
}

impl<'c> Scan<'c> {
    fn new(column: &'c JointColumn, every: usize) -> Self {
        let rows: Vec<usize> = (0..column.q.len()).step_by(every).collect();
        let mut imitated = column.imitated.select_columns(&rows).transpose();
        imitated *= every as f64;
        Self { column, every, imitated }
    }

    /// What cosine and sine of `count` orders from `first` on would each explain. Rows are taken
    /// a few hundred at a time, so that their waves stay in the cache.
    fn strengths(&self, first: f64, step: f64, count: usize) -> Vec<f64> {
        let n = self.column.q.len();
        let mut sums = vec![[0.0; 5]; count];
        let mut imitated = DMatrix::zeros(2 * count, self.imitated.ncols());
        let mut seen = 0;
        for start in (0..n).step_by(self.every * ROWS) {
            let block = start..n.min(start + self.every * ROWS);
            let mut waves = Waves::new(&self.column.q[block.clone()], first, Some(step));
            let (square, right) = (&self.column.square[block.clone()], &self.column.right[block]);
            let rows = square.len().div_ceil(self.every);
            let mut few = DMatrix::zeros(2 * count, rows);
            for (k, sums) in sums.iter_mut().enumerate() {
                waves.add(square, right, sums);
                for (j, i) in (0..square.len()).step_by(self.every).enumerate() {
                    few[(2 * k, j)] = waves.cos[i];
                    few[(2 * k + 1, j)] = waves.sin[i];
                }
                waves.turn();
            }
            imitated.gemm(1.0, &few, &self.imitated.rows(seen, rows), 1.0);
            seen += rows;
        }
        // Waves are a column of both.
        let imitated = imitated.transpose();
        let of = |(k, sums): (usize, &[f64; 5])| {
            let imitated = imitated.columns(2 * k, 2).into_owned();
            // What geometry does much of hangs on how much exactly.
            match self.every > 1 && imitated.norm_squared() > IMITATED * (sums[0] + sums[2]) {
                true => self.column.strength(&self.column.right, first + step * k as f64),
                false => Pair { sums: *sums, imitated }.strength(),
            }
        };
        sums.iter().enumerate().map(of).collect()
    }
}

/// Cosine and sine of an order at some values; from one order to the next by a rotation, no
/// sine for each.
struct Waves {
    cos: Vec<f64>,
    sin: Vec<f64>,
    step: Vec<(f64, f64)>,
}

impl Waves {
    fn new(q: &[f64], first: f64, step: Option<f64>) -> Self {
        let (sin, cos) = q.iter().map(|q| (q * first).sin_cos()).unzip();
        let turn = |step: f64| q.iter().map(|q| (q * step).sin_cos()).collect();
        Self { cos, sin, step: step.map_or_else(Vec::new, turn) }
    }

    fn turn(&mut self) {
        let waves = self.cos.iter_mut().zip(&mut self.sin);
        for ((cos, sin), (step_sin, step_cos)) in waves.zip(&self.step) {
            (*sin, *cos) = (*sin * step_cos + *cos * step_sin, *cos * step_cos - *sin * step_sin);
        }
    }

    /// Adds cos cos, cos sin and sin sin times the squares, cos and sin times the right sides:
    /// several sums side by side, as a processor has them.
    fn add(&self, square: &[f64], right: &[f64], sums: &mut [f64; 5]) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// No geometry: a column of length 1 and a residual along it.
    fn column(lines: &[(f64, f64)]) -> JointColumn {
        let q: Vec<f64> = (0..200).map(|i| -2.0 + 0.02 * f64::from(i)).collect();
        let wave = |q: &f64| lines.iter().map(|(n, a)| a * (n * q + 0.3).sin()).sum::<f64>();
        let right: Vec<f64> = q.iter().map(wave).collect();
        JointColumn { square: vec![1.0; q.len()], imitated: DMatrix::zeros(1, q.len()), right, q }
    }

    #[test]
    fn the_lines_are_found_and_whole_numbers_offered() {
        let column = column(&[(20.0, 1.0), (31.4, 0.6)]);
        let orders = Orders::of(&column.q, 64.0);
        let found = orders.lines(&column, 2);
        assert!((found[0].order - 20.0).abs() < orders.step, "{found:?}");
        assert!((found[1].order - 31.4).abs() < orders.step, "{found:?}");
        assert!(orders.variants(&found[0]).contains(&20.0));
        assert!(orders.log_odds(6, 20.0) > orders.log_odds(6, 20.1));
    }

    /// On both sides of the number of rows from which some stand for all: the same orders, of
    /// the same strengths, where geometry imitates much of the lowest.
    #[test]
    fn some_rows_rank_orders_as_all_do() {
        let mut seed = 1_u64;
        let mut uniform = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for n in [LOOKS, LOOKS + 1, 3 * LOOKS + 7] {
            let q: Vec<f64> = (0..n).map(|_| 5.0 * uniform() - 2.5).collect();
            let unit = (n as f64).sqrt();
            let geometry = [1.0, 2.0, 3.0].map(|order: f64| {
                q.iter().map(move |q| 1.3 * (order * q).cos() / unit).collect::<Vec<_>>()
            });
            let imitated = DMatrix::from_fn(3, n, |i, j| geometry[i][j]);
            let lines = [(6.3, 0.5), (17.0, 0.3), (88.4, 0.25), (250.0, 0.2)];
            let wave = |q: &f64| lines.iter().map(|(n, a)| a * (n * q).sin()).sum::<f64>();
            let right = q.iter().map(|q| wave(q) + uniform() - 0.5).collect();
            let column = JointColumn { square: vec![1.0; n], right, imitated, q };
            let orders = Orders::of(&column.q, 300.0);
            let [found, exact] =
                [orders.lines(&column, 8), orders.lines_by(&Scan::new(&column, 1), 8)];
            for (expected, _) in lines {
                let near = |line: &Line| (line.order - expected).abs() < 2.0 * orders.step;
                assert!(found.iter().any(near), "{n}: {found:?}");
            }
            // As if every order had been summed over all rows.
            for (line, exact) in found.iter().zip(&exact).take(5) {
                assert_eq!(line.order, exact.order, "{n}: {found:?} {exact:?}");
                let apart = (line.strength - exact.strength).abs();
                assert!(apart < 1e-9 * exact.strength, "{n}: {line:?} {exact:?}");
            }
        }
    }

    /// Least squares of both columns, projected, against the formula.
    #[test]
    fn strength_is_what_least_squares_explains() {
        let mut column = column(&[(7.0, 1.0)]);
        let n = column.q.len();
        // Geometry: a constant, whitened so that P = I - 11'/n.
        column.imitated = DMatrix::from_element(1, n, 1.0 / (n as f64).sqrt());
        let mean = column.right.iter().sum::<f64>() / n as f64;
        column.right.iter_mut().for_each(|r| *r -= mean);
        let direct = |order: f64| {
            let mut a = DMatrix::from_fn(n, 2, |i, k| {
                let phase = order * column.q[i];
                if k == 0 { phase.cos() } else { phase.sin() }
            });
            for mut c in a.column_iter_mut() {
                let mean = c.mean();
                c.add_scalar_mut(-mean);
            }
            let y = nalgebra::DVector::from_column_slice(&column.right);
            let b = a.tr_mul(&y);
            let x = (a.tr_mul(&a)).try_inverse().map(|inverse| inverse * &b);
            x.map_or(0.0, |x| x.dot(&b))
        };
        for order in [3.0, 6.9, 7.0, 12.3] {
            let of_many = Scan::new(&column, 1).strengths(order, 0.1, 3)[0];
            for own in [column.strength(&column.right, order), of_many] {
                assert!((own - direct(order)).abs() < 1e-8 * (1.0 + own), "{order}");
            }
        }
    }
}
