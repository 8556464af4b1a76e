//! Which rows are readings of one thing.

use super::kind;
use crate::model::{KindId, Row};

/// What readings that the arm moves alike have in common: where it stood, at both ends of a
/// pair, and what was measured there, of whatever target on its flange. A hole of a plate is
/// another than the next one. The corners that a camera sees in a pose are one image.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Reading<'a> {
    kind: KindId,
    station: usize,
    /// `None` of all targets.
    marker: Option<usize>,
    pose: usize,
    partner: Option<usize>,
    refers: &'a [usize],
    known: Vec<u64>,
}

impl<'a> Reading<'a> {
    /// That of a row.
    fn of(rows: &'a [Row], index: usize) -> Self {
        let row = &rows[index];
        let columns = kind(row).columns().len();
        let own = if kind(row).is_image() { row.measured.len() } else { columns };
        let known = row.measured.iter().skip(own);
        Self {
            kind: row.kind,
            station: row.station,
            marker: None,
            pose: row.pose,
            partner: row.partner.map(|partner| rows[partner].pose),
            refers: &row.refers,
            known: known.map(|v| v.to_bits()).collect(),
        }
    }

    /// The same of one target: such readings repeat one thing, but for the corners of an image.
    fn of_target(rows: &'a [Row], index: usize) -> Self {
        Self { marker: Some(rows[index].marker), ..Self::of(rows, index) }
    }
}

/// Places in `of` of rows that the arm moves alike, a list each.
#[must_use]
pub fn by_pose(rows: &[Row], of: &[usize]) -> Vec<Vec<usize>> {
    alike(of, |row| Reading::of(rows, row))
}

/// The same of each target by itself.
#[must_use]
pub fn by_target(rows: &[Row], of: &[usize]) -> Vec<Vec<usize>> {
    alike(of, |row| Reading::of_target(rows, row))
}

fn alike<'a>(of: &[usize], key: impl Fn(usize) -> Reading<'a>) -> Vec<Vec<usize>> {
    let key = |k: usize| key(of[k]);
    let mut order: Vec<usize> = (0..of.len()).collect();
    order.sort_by_cached_key(|k| (key(*k), *k));
    order.chunk_by(|a, b| key(*a) == key(*b)).map(<[usize]>::to_vec).collect()
}

/// Whether readings of a pose repeat one thing: they differ by noise then. Corners of an image
/// and targets on the flange are apart by what the arm is off by as well.
#[must_use]
pub fn repeat(rows: &[Row], readings: &[usize]) -> bool {
    let [first, others @ ..] = readings else { return true };
    let row = &rows[*first];
    !kind(row).is_image() && others.iter().all(|other| rows[*other].marker == row.marker)
}

/// Places among the readings of a pose at each of its visits: what a joint is off by as it came to
/// rest is the same until the arm has been away.
#[must_use]
pub fn visits(rows: &[Row], readings: &[usize]) -> Vec<Vec<usize>> {
    let mut out: Vec<Vec<usize>> = Vec::new();
    for (k, row) in readings.iter().enumerate() {
        let stays = |before: &usize| (*before..*row).all(|r| rows[r].pose == rows[*row].pose);
        match out.last_mut() {
            Some(visit) if stays(&readings[k - 1]) => visit.push(k),
            _ => out.push(vec![k]),
        }
    }
    out
}

/// Rows at which the arm stood for what some rows measure: of a pair both ends.
#[must_use]
pub fn postures(rows: &[Row], of: &[usize]) -> Vec<usize> {
    of.iter().flat_map(|row| std::iter::once(*row).chain(rows[*row].partner)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_visit_lasts_until_the_arm_goes_elsewhere() {
        let at = |pose: usize| Row { pose, ..Row::at(vec![0.0]) };
        let rows: Vec<Row> = [0, 0, 1, 0, 1, 1, 0].map(at).into();
        assert_eq!(visits(&rows, &[0, 1, 3, 6]), [vec![0, 1], vec![2], vec![3]]);
        assert_eq!(visits(&rows, &[2, 4, 5]), [vec![0], vec![1, 2]]);
        assert_eq!(visits(&rows, &[3]), [[0]]);
    }
}
