//! A part as a file. All numbers little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 12 | `truearm gram` |
//! | 4 | version, 2 |
//! | 8 | digest of the state |
//! | 3 x 8 | unknowns, joints, stations times markers |
//! | 4 x 8 | files, rows, poses, rows that do not count |
//! | a fold each | equations, rows (u64), sum of 1/sigma^2, lower triangle of `[A, b]'[A, b]` by columns (f64) |
//! | 2743 x 8 | counts of residuals |
//! | a joint each | smallest, largest value |
//! | a marker each, station by station | count, nine numbers by columns |
//! | 16 x 8 | count, sums, product of the points |
//! | (36 + 6 x unknowns) x 8 | normal matrix and pull of the frame, by columns |
//! | 8 + 8 each | number of parts that it was merged of, their digests in order; none of one that was not. Version 1 lacks it |
//! | 4 | CRC-32/ISCSI of all before |

use crc::{CRC_32_ISCSI, Crc};
use nalgebra::{DMatrix, Matrix3, Matrix6, Matrix6xX, Vector3};

use super::FOLDS;
use super::histogram::{BINS, Histogram};
use super::part::{FoldSums, Part};
use crate::identify::Turns;
use crate::identify::certainty::covariance::FrameSums;
use crate::identify::start::Pairs;
use crate::tikhonov::Normal;

const MAGIC: &[u8; 12] = b"truearm gram";
const VERSION: u32 = 2;
/// The layout before: nothing of the parts that it was merged of.
const WITHOUT_PARTS: u32 = 1;
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);
/// More unknowns, joints or markers than anything has.
const MOST: u64 = 1 << 14;

/// Whether bytes begin as those of a part do.
#[must_use]
pub fn is_part(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Why bytes are no part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoPart {
    /// They begin otherwise.
    #[error("no .gram file")]
    Magic,
    /// Another layout.
    #[error(
        "version {0} of the .gram layout, of which this program reads {WITHOUT_PARTS} and {VERSION}"
    )]
    Version(u32),
    /// Too short, too long or changed.
    #[error("a .gram file that is cut off or damaged")]
    Damaged,
}

impl Part {
    /// As a file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = MAGIC.to_vec();
        out.extend(VERSION.to_le_bytes());
        out.extend(self.content());
        for value in [self.merged.len() as u64].iter().chain(&self.merged) {
            out.extend(value.to_le_bytes());
        }
        let crc = CRC.checksum(&out);
        out.extend(crc.to_le_bytes());
        out
    }

    /// What it says, the same in every version.
    pub(super) fn content(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let whole = |out: &mut Vec<u8>, value: u64| out.extend(value.to_le_bytes());
        let unknowns = self.frame.pull.ncols();
        let sizes = [unknowns, self.covered.len(), self.turns.len()].map(|n| n as u64);
        let counts = [self.files, self.rows, self.poses, self.flagged];
        for value in [self.state].into_iter().chain(sizes).chain(counts) {
            whole(&mut out, value);
        }
        for fold in &self.folds {
            whole(&mut out, fold.normal.equations() as u64);
            whole(&mut out, fold.rows);
            let gram = fold.normal.gram();
            let triangle = (0..=unknowns).flat_map(|j| (j..=unknowns).map(move |i| gram[(i, j)]));
            reals(&mut out, std::iter::once(fold.precision).chain(triangle));
        }
        self.residuals.0.iter().for_each(|count| whole(&mut out, *count));
        reals(&mut out, self.covered.iter().flatten().copied());
        let turns = |t: &Turns| std::iter::once(t.count).chain(t.sum.iter().copied()).collect();
        reals(&mut out, self.turns.iter().flat_map(|t| -> Vec<f64> { turns(t) }));
        let Pairs { count, sums, product } = &self.points;
        reals(&mut out, std::iter::once(*count).chain(sums.iter().flatten().copied()));
        reals(&mut out, product.iter().copied());
        reals(&mut out, self.frame.normal.iter().chain(self.frame.pull.iter()).copied());
        out
    }

    /// Reads a file.
    ///
    /// # Errors
    /// Bytes that are none, of another version, cut off or damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, NoPart> {
        if !is_part(bytes) {
            return Err(NoPart::Magic);
        }
        let (body, crc) = bytes.split_last_chunk().ok_or(NoPart::Damaged)?;
        let mut from = Reader(body.get(MAGIC.len()..).ok_or(NoPart::Damaged)?);
        let version = u32::from_le_bytes(from.take()?);
        if ![WITHOUT_PARTS, VERSION].contains(&version) {
            return Err(NoPart::Version(version));
        }
        if CRC.checksum(body) != u32::from_le_bytes(*crc) {
            return Err(NoPart::Damaged);
        }
        let mut part = from.part()?;
        if version == VERSION {
            part.merged = from.merged()?;
        }
        if from.0.is_empty() { Ok(part) } else { Err(NoPart::Damaged) }
    }
}

fn reals(out: &mut Vec<u8>, values: impl Iterator<Item = f64>) {
    values.for_each(|value| out.extend(value.to_le_bytes()));
}

/// What is left to read.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], NoPart> {
        let (first, rest) = self.0.split_first_chunk().ok_or(NoPart::Damaged)?;
        self.0 = rest;
        Ok(*first)
    }

    fn whole(&mut self) -> Result<u64, NoPart> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    /// A number of things that are read one by one.
    fn size(&mut self) -> Result<usize, NoPart> {
        let size = self.whole()?;
        if size <= MOST { Ok(size as usize) } else { Err(NoPart::Damaged) }
    }

    fn reals(&mut self, count: usize) -> Result<Vec<f64>, NoPart> {
        if self.0.len() / 8 < count {
            return Err(NoPart::Damaged);
        }
        // Sums of measurements are numbers; a checksum over others is no reason to believe them.
        let real = |value: f64| if value.is_finite() { Ok(value) } else { Err(NoPart::Damaged) };
        (0..count).map(|_| real(f64::from_le_bytes(self.take()?))).collect()
    }

    fn part(&mut self) -> Result<Part, NoPart> {
        let state = self.whole()?;
        let (unknowns, joints, turns) = (self.size()?, self.size()?, self.size()?);
        let (files, rows, poses, flagged) =
            (self.whole()?, self.whole()?, self.whole()?, self.whole()?);
        let folds = (0..FOLDS).map(|_| self.fold(unknowns)).collect::<Result<_, _>>()?;
        let residuals = (0..BINS).map(|_| self.whole()).collect::<Result<_, _>>()?;
        let covered = self.reals(2 * joints)?.chunks(2).map(|c| [c[0], c[1]]).collect();
        let turns = self.reals(10 * turns)?;
        let turns = turns
            .chunks(10)
            .map(|c| Turns { count: c[0], sum: Matrix3::from_column_slice(&c[1..]) })
            .collect();
        let points = self.reals(16)?;
        let sum = |k: usize| Vector3::from_column_slice(&points[1 + 3 * k..4 + 3 * k]);
        let points = Pairs {
            count: points[0],
            sums: [sum(0), sum(1)],
            product: Matrix3::from_column_slice(&points[7..]),
        };
        let frame = FrameSums {
            normal: Matrix6::from_column_slice(&self.reals(36)?),
            pull: Matrix6xX::from_column_slice(&self.reals(6 * unknowns)?),
        };
        let residuals = Histogram(residuals);
        Ok(Part {
            state,
            files,
            rows,
            poses,
            flagged,
            folds,
            residuals,
            covered,
            turns,
            points,
            frame,
            merged: Vec::new(),
        })
    }

    /// Digests of parts: as many as there are bytes for, each once and in order.
    fn merged(&mut self) -> Result<Vec<u64>, NoPart> {
        let count = self.whole()?;
        if count > self.0.len() as u64 / 8 {
            return Err(NoPart::Damaged);
        }
        let all: Vec<u64> = (0..count).map(|_| self.whole()).collect::<Result<_, _>>()?;
        if all.is_sorted_by(|a, b| a < b) { Ok(all) } else { Err(NoPart::Damaged) }
    }

    fn fold(&mut self, unknowns: usize) -> Result<FoldSums, NoPart> {
        let (equations, rows) = (self.whole()?, self.whole()?);
        let precision = self.reals(1)?[0];
        if precision < 0.0 {
            return Err(NoPart::Damaged);
        }
        let size = unknowns + 1;
        let triangle = self.reals(size * (size + 1) / 2)?;
        let mut gram = DMatrix::zeros(size, size);
        let places = (0..size).flat_map(|j| (j..size).map(move |i| (i, j)));
        for ((i, j), value) in places.zip(triangle) {
            (gram[(i, j)], gram[(j, i)]) = (value, value);
        }
        Ok(FoldSums { normal: Normal::of_gram(gram, equations as usize), rows, precision })
    }
}
