//! Lines, periodic errors of unknown order: every order is tried alone at a
//! joint, in O(n (p + 2) K) and without a matrix of all orders; the best and
//! their neighbours become candidates.

mod column;
mod scan;

pub use column::JointColumn;
use scan::Scan;

/// Below lies eccentricity, and what a limited range of a joint cannot tell
/// from geometry. Cycles a turn.
pub const LOWEST: f64 = 2.6;
/// Orders tried in one matrix product.
const BATCH: usize = 64;
/// So many rows say as well as all what geometry imitates of an order, to rank orders by...
const LOOKS: usize = 3000;
/// ...of so many times as many as are asked for it is summed over all.
const AGAIN: usize = 4;
/// Lines closer than this in steps of the grid are one line.
const APART: f64 = 2.0;
/// Neighbours of a peak that become candidates, in steps of the grid.
const NEIGHBOURS: [f64; 5] = [0.0, -0.5, 0.5, -1.0, 1.0];

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

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

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
