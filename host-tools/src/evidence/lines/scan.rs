//! Many orders at once.

use nalgebra::DMatrix;

use super::column::{JointColumn, Pair, Waves};

/// Rows that are taken together.
const ROWS: usize = 256;
/// What geometry imitates of an order is told by some of the rows up to this share of its
/// squares: a line that geometry does four fifths of was lost beyond it.
const IMITATED: f64 = 0.05;

/// A column ready for many orders.
pub(super) struct Scan<'c> {
    pub column: &'c JointColumn,
    /// What geometry imitates is summed over each so many-th row, which stands for the others:
    /// of thousands of rows it is little, and takes most of the time.
    pub every: usize,
    /// Of those rows, one row a row.
    imitated: DMatrix<f64>,
}

impl<'c> Scan<'c> {
    pub fn new(column: &'c JointColumn, every: usize) -> Self {
        let rows: Vec<usize> = (0..column.q.len()).step_by(every).collect();
        let mut imitated = column.imitated.select_columns(&rows).transpose();
        imitated *= every as f64;
        Self { column, every, imitated }
    }

    /// What cosine and sine of `count` orders from `first` on would each explain. Rows are taken
    /// a few hundred at a time, so that their waves stay in the cache.
    pub fn strengths(&self, first: f64, step: f64, count: usize) -> Vec<f64> {
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
