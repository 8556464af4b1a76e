//! Targets of one pose that turn together: what joints scatter turns the flange, and moves
//! targets on it apart the same way in every reading of the pose.

use nalgebra::{DMatrix, DVector, Vector3};

use super::Sheet;
use crate::evidence::directed::{self, Seen, whiten};
use crate::evidence::poses;
use crate::identify::Problem;
use crate::observations::{by_pose, kind, repeat};
use crate::statistics::repeats::ENOUGH;

impl Sheet<'_> {
    /// Equations of corners of an image, or of several targets, which turn with the flange,
    /// whitened.
    pub(super) fn of_targets(&self, mut block: DMatrix<f64>, readings: &[usize]) -> DMatrix<f64> {
        let ways = ways(self.problem, readings).filter(|_| self.weights.turning > 0.0);
        let Some(ways) = ways else {
            poses::whiten(&mut block, readings.len(), self.weights.common);
            return block;
        };
        let (own, each) = (block.ncols(), ways.nrows() / readings.len());
        let mut block = block.insert_columns(own, 3, 0.0);
        block.columns_mut(own, 3).copy_from(&ways);
        for (k, index) in readings.iter().enumerate() {
            let weight = self.weights.rows[*index].sqrt();
            block.view_mut((k * each, own), (each, 3)).scale_mut(weight);
        }
        poses::whiten(&mut block, readings.len(), self.weights.common);
        without(block, self.weights.turning)
    }
}

/// How a turn of the flange about each axis moves readings of several targets in one pose, in
/// stated sigmas a rad; `None` where they are no points, or of one target.
fn ways(problem: &Problem, readings: &[usize]) -> Option<DMatrix<f64>> {
    let rows = &problem.data.rows;
    if repeat(rows, readings) {
        return None;
    }
    let point = |row: &usize| kind(&rows[*row]).point(&rows[*row]);
    let points: Vec<Vector3<f64>> = readings.iter().map(point).collect::<Option<_>>()?;
    let middle = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let scales: Vec<_> = readings.iter().map(|row| problem.scale(*row)).collect();
    let components = scales[0].len();
    // A turn that is measured by itself is common to the pose already.
    let way = |equation: usize, axis: usize| {
        let (reading, component) = (equation / components, equation % components);
        let mut turn = Vector3::zeros();
        turn[axis] = 1.0;
        let moved = turn.cross(&(points[reading] - middle));
        if component < 3 { moved[component] / scales[reading][component] } else { 0.0 }
    };
    Some(DMatrix::from_fn(components * readings.len(), 3, way))
}

/// Variance of such a turn, rad^2, over that of what readings of a pose do not share, from the
/// residuals of these rows in sigmas, of which a pose has so much in common; 0 of fewer poses
/// than tell it.
#[must_use]
pub fn ratio(problem: &Problem, rows: &[usize], residuals: &[Vec<f64>], common: f64) -> f64 {
    if problem.data.markers.len() < 2 {
        return 0.0;
    }
    let mut seen = Vec::new();
    let mut count = 0;
    for places in by_pose(&problem.data.rows, rows) {
        let readings: Vec<usize> = places.iter().map(|k| rows[*k]).collect();
        let Some(ways) = ways(problem, &readings) else { continue };
        count += 1;
        let residual = places.iter().flat_map(|k| residuals[*k].iter().copied());
        let residual = DVector::from_iterator(ways.nrows(), residual);
        let mut all = ways.insert_column(3, 0.0);
        all.column_mut(3).copy_from(&residual);
        poses::whiten(&mut all, readings.len(), common);
        seen.extend(Seen::each(&all.columns(0, 3).into(), &all.column(3).into()));
    }
    if count < ENOUGH { 0.0 } else { directed::ratio(&seen) }
}

/// Equations of one pose, whose last three columns are [`ways`]: without them, the noise the
/// same every way.
fn without(mut block: DMatrix<f64>, ratio: f64) -> DMatrix<f64> {
    let own = block.ncols() - 3;
    for axis in 0..3 {
        let way: DVector<f64> = block.column(own + axis).into_owned();
        whiten(&mut block, &way, ratio);
    }
    block.remove_columns(own, 3)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// The covariance of what comes out is the identity.
    #[test]
    fn what_turns_together_is_whitened() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..20 {
            let ways = DMatrix::from_fn(9, 3, |_, _| rng.random_range(-2.0..2.0));
            let ratio = rng.random_range(0.0..5.0);
            let v = DMatrix::identity(9, 9) + &ways * ways.transpose() * ratio;
            let whitening = |columns: &DMatrix<f64>| {
                let mut all = columns.clone().insert_columns(columns.ncols(), 3, 0.0);
                all.columns_mut(columns.ncols(), 3).copy_from(&ways);
                without(all, ratio)
            };
            let half = whitening(&v);
            let whole = whitening(&half.transpose());
            assert!((whole - DMatrix::identity(9, 9)).amax() < 1e-9);
        }
    }

    #[test]
    fn the_ratio_of_three_axes_is_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for truth in [0.0, 0.5, 3.0] {
            let mut normal =
                |k: f64| k * ((0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0);
            let mut seen = Vec::new();
            for _ in 0..3000 {
                let ways = DMatrix::from_fn(9, 3, |_, _| normal(1.0));
                let turn = DVector::from_fn(3, |_, _| normal(f64::sqrt(truth)));
                let residual = &ways * turn + DVector::from_fn(9, |_, _| normal(1.0));
                seen.extend(Seen::each(&ways, &residual));
            }
            let found = directed::ratio(&seen);
            assert!((found - truth).abs() < 0.02 + 0.2 * truth, "{truth}: {found}");
        }
    }
}
