//! Which rows are readings of one thing.

use super::kind;
use crate::model::{KindId, Row};

/// What readings of one thing have in common: where the arm stood, at both ends of a
/// pair, and what was measured there. A hole of a plate is another than the next one. The
/// corners that a camera sees in a pose are one image: what the arm is off by there moves all.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reading<'a> {
    kind: KindId,
    station: usize,
    marker: usize,
    pose: usize,
    partner: Option<usize>,
    refers: &'a [usize],
    known: Vec<u64>,
}

impl<'a> Reading<'a> {
    /// That of a row.
    #[must_use]
    pub fn of(rows: &'a [Row], index: usize) -> Self {
        let row = &rows[index];
        let columns = kind(row).columns().len();
        let own = if kind(row).is_image() { row.measured.len() } else { columns };
        let known = row.measured.iter().skip(own);
        Self {
            kind: row.kind,
            station: row.station,
            marker: row.marker,
            pose: row.pose,
            partner: row.partner.map(|partner| rows[partner].pose),
            refers: &row.refers,
            known: known.map(|v| v.to_bits()).collect(),
        }
    }
}

/// Rows at which the arm stood for what some rows measure: of a pair both ends.
#[must_use]
pub fn postures(rows: &[Row], of: &[usize]) -> Vec<usize> {
    of.iter().flat_map(|row| std::iter::once(*row).chain(rows[*row].partner)).collect()
}
