//! Rows that say the same to the last digit, wherever in the files they stand: nothing is measured
//! twice.

use std::hash::{DefaultHasher, Hash, Hasher};

use super::{Pieces, Place};
use crate::error::Result;
use crate::model::near::cell;
use crate::model::{Measurements, Row};

/// Of rows that stand several times the first.
pub struct Twice {
    /// By their hash.
    first: Vec<(u64, Place)>,
}

impl Twice {
    /// Keeps rows that are the first of their like; `place` is that of the first one here.
    pub fn keep(&self, place: Place, data: &mut Measurements) {
        let counts = |(k, row): (usize, &Row)| {
            let key = said(data, row);
            let known = self.first.binary_search_by_key(&key, |(key, _)| *key);
            known.map_or(true, |known| self.first[known].1 == place.on(k))
        };
        let kept: Vec<bool> = data.rows.iter().enumerate().map(counts).collect();
        let mut kept = kept.into_iter();
        data.rows.retain(|_| kept.next().unwrap_or(true));
    }
}

/// Hash of all that a row says.
fn said(data: &Measurements, row: &Row) -> u64 {
    let mut hash = DefaultHasher::new();
    (&data.stations[row.station], &data.markers[row.marker], &row.series).hash(&mut hash);
    let known = [row.time, row.temperature, row.payload, row.order];
    let known = known.iter().map(|value| value.map_or(u64::MAX, f64::to_bits));
    let numbers = row.q.iter().chain(row.measured.iter()).chain(&row.torques).chain([&row.sigma]);
    known.chain(numbers.map(|v| v.to_bits())).for_each(|bits| bits.hash(&mut hash));
    hash.finish()
}

/// Values that stand there more than once, each once; of sorted ones.
pub fn repeated(sorted: &[u64]) -> Vec<u64> {
    let mut out: Vec<u64> =
        sorted.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    out.dedup();
    out
}

/// Both together, sorted: each is.
pub fn merged(mut a: Vec<u64>, mut b: Vec<u64>) -> Vec<u64> {
    a.append(&mut b);
    // Of two sorted ones: one pass.
    a.sort();
    a
}

impl Pieces<'_> {
    /// Looks for rows that stand several times among poses that do, whose cells these are,
    /// sorted: from then on the first of them counts. How many do not.
    ///
    /// # Errors
    /// As for [`Pieces::fold`].
    pub(super) fn find_twice(&mut self, cells: &[u64]) -> Result<usize> {
        if cells.is_empty() {
            return Ok(0);
        }
        let kinds = self.kinds();
        let among = |row: &Row| cells.binary_search(&cell(&row.q, kinds.iter().copied())).is_ok();
        let keys = |_, data: Measurements| {
            let own = data.rows.iter().filter(|row| among(row)).map(|row| said(&data, row));
            let mut own: Vec<u64> = own.collect();
            own.sort_unstable();
            Ok(Some(own))
        };
        let all = self.blocks(&keys, &|a, b| Ok(merged(a, b)))?;
        let mut several = all.clone();
        several.dedup();
        let spare = all.len() - several.len();
        drop(several);
        let several = repeated(&all);
        drop(all);
        if several.is_empty() {
            return Ok(0);
        }
        let firsts = |place: Place, data: Measurements| {
            let own = data.rows.iter().enumerate().map(|(k, row)| (said(&data, row), place.on(k)));
            let own = own.filter(|(key, _)| several.binary_search(key).is_ok());
            Ok(Some(first(own.collect())))
        };
        let join = |mut a: Vec<(u64, Place)>, b: Vec<(u64, Place)>| {
            a.extend(b);
            Ok(first(a))
        };
        self.twice = Some(Twice { first: self.blocks(&firsts, &join)? });
        Ok(spare)
    }
}

/// Of each key the first place.
fn first(mut all: Vec<(u64, Place)>) -> Vec<(u64, Place)> {
    all.sort();
    all.dedup_by_key(|(key, _)| *key);
    all
}
