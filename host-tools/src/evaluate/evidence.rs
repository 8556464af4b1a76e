//! Rows of a file that was not fitted which stand out by their own evidence.

use crate::identify::{Group, groups};
use crate::model::Measurements;
use crate::observations::{Residual, kind};
use crate::statistics::median;

/// A row that is so many robust standard deviations off is left out.
const BEYOND: f64 = 10.0;
/// Of fewer rows than these of a kind the scatter is not known well enough to be believed
/// smaller than stated: chance makes three of four agree.
const FEW: usize = 30;
/// Medians of the chi distribution with one, two and three degrees of freedom.
const MIDDLES: [f64; 3] = [0.674_490, 1.177_410, 1.538_172];

/// Rows beyond 10 robust standard deviations of the rows of their kind, each unit of it on its
/// own. A few are slips of the measurement; of more it is the model that misses them, or the
/// file that is wrong, and their errors count.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct StandingOut {
    /// The worst, at most 1 % of the rows: left out.
    pub left_out: Vec<usize>,
    /// The others: counted.
    pub counted: Vec<usize>,
}

/// Rows that stand out, each list in their order.
#[must_use]
pub fn own_evidence(data: &Measurements, residuals: &[Residual]) -> StandingOut {
    let mut far = vec![0.0_f64; residuals.len()];
    for group in groups(data) {
        for (row, off) in deviations(data, residuals, group) {
            far[row] = far[row].max(off);
        }
    }
    let mut rows: Vec<usize> = (0..far.len()).filter(|row| far[*row] > BEYOND).collect();
    rows.sort_by(|a, b| far[*b].total_cmp(&far[*a]));
    let measured = residuals.iter().filter(|r| !r.is_empty()).count();
    let mut counted = rows.split_off(rows.len().min(measured / 100));
    rows.sort_unstable();
    counted.sort_unstable();
    StandingOut { left_out: rows, counted }
}

/// How far off the rows of a group are, in its own robust standard deviations.
fn deviations(data: &Measurements, residuals: &[Residual], group: Group) -> Vec<(usize, f64)> {
    let off = |row: usize| {
        let (own, residual) = (&data.rows[row], &residuals[row]);
        let sigmas = kind(own).sigmas(own);
        let own: Vec<f64> = group
            .components(own)
            .filter(|c| *c < residual.len())
            .map(|c| residual[c] / sigmas[c])
            .collect();
        let middle = MIDDLES.get(own.len().checked_sub(1)?)?;
        Some((row, own.iter().map(|v| v * v).sum::<f64>().sqrt(), *middle))
    };
    let all: Vec<(usize, f64, f64)> = (0..residuals.len()).filter_map(off).collect();
    let scale = median(&all.iter().map(|(_, off, middle)| off / middle).collect::<Vec<_>>());
    let scale = if all.len() < FEW { scale.max(1.0) } else { scale };
    let far = all.into_iter().filter(|(_, off, _)| *off > 0.0);
    far.map(|(row, off, _)| (row, off / scale)).collect()
}
