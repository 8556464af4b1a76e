use super::FOLDS;
use super::histogram::Histogram;
use crate::error::{Error, ErrorKind, Result};
use crate::files::digest_of_bytes;
use crate::identify::Turns;
use crate::identify::certainty::covariance::FrameSums;
use crate::identify::start::Pairs;
use crate::tikhonov::Normal;

/// Sums over the rows of a fold that count.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FoldSums {
    /// Normal equations about the state, in units of the problem.
    pub normal: Normal,
    /// Rows.
    pub rows: u64,
    /// Sum of their 1/sigma^2, 1/m^2.
    pub precision: f64,
}

/// What some rows of an arm's measurements say at a state, in sums.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Digest of the state: sums at different ones have nothing in common.
    pub(super) state: u64,
    /// Files that it was made of, and the rows and poses in them; a pose whose rows are in two
    /// of them counts twice.
    pub(super) files: u64,
    pub(super) rows: u64,
    pub(super) poses: u64,
    /// Rows that do not count.
    pub(super) flagged: u64,
    pub(super) folds: Vec<FoldSums>,
    /// Of all rows that count; in the first round of all.
    pub(super) residuals: Histogram,
    /// Smallest and largest value of each joint.
    pub(super) covered: Vec<[f64; 2]>,
    /// Of each station every marker's.
    pub(super) turns: Vec<Turns>,
    /// Identified and nominal tool points.
    pub(super) points: Pairs,
    pub(super) frame: FrameSums,
    /// Digests of the parts that it was merged of, in their order; none of one that was not.
    pub(super) merged: Vec<u64>,
}

impl Part {
    /// Of no rows.
    pub(super) fn none(state: u64, unknowns: usize, joints: usize, turns: usize) -> Self {
        let fold = || FoldSums { normal: Normal::none(unknowns), rows: 0, precision: 0.0 };
        Self {
            state,
            files: 0,
            rows: 0,
            poses: 0,
            flagged: 0,
            folds: (0..FOLDS).map(|_| fold()).collect(),
            residuals: Histogram::default(),
            covered: vec![[f64::INFINITY, f64::NEG_INFINITY]; joints],
            turns: vec![Turns::default(); turns],
            points: Pairs::default(),
            frame: FrameSums::none(unknowns),
            merged: Vec::new(),
        }
    }

    /// Unknowns, joints, and markers of all stations.
    pub(super) fn shape(&self) -> [usize; 3] {
        [self.frame.pull.ncols(), self.covered.len(), self.turns.len()]
    }

    /// Rows, all of them.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Rows that do not count at this state.
    #[must_use]
    pub fn flagged(&self) -> u64 {
        self.flagged
    }

    /// Files that it was made of.
    #[must_use]
    pub fn files(&self) -> u64 {
        self.files
    }

    /// Digests of the parts that it was merged of, in their order; of one that was not merged
    /// its own. Parts without a row are all alike, and none counts anything twice.
    #[must_use]
    pub fn sources(&self) -> Vec<u64> {
        match self.merged.is_empty() {
            true if self.rows == 0 => Vec::new(),
            true => vec![digest_of_bytes(&self.content())],
            false => self.merged.clone(),
        }
    }

    /// Sums of what neither counted before.
    ///
    /// # Errors
    /// [`ErrorKind::OtherArm`] of parts at different states, and a part that both were merged
    /// of.
    pub fn plus(self, other: &Self) -> Result<Self> {
        let mut merged = [self.sources(), other.sources()].concat();
        let all = merged.len();
        merged.sort_unstable();
        merged.dedup();
        if merged.len() < all {
            return Err(Error::usage(
                "both hold the same part: its rows would count twice",
                "give every part once, by itself or in a merged one",
            ));
        }
        Ok(Self { merged, ..self.joined(other)? })
    }

    /// The same of what is to be one part.
    ///
    /// # Errors
    /// As for [`Part::plus`], but for a part that both hold.
    pub(super) fn joined(self, other: &Self) -> Result<Self> {
        if self.state != other.state || self.shape() != other.shape() {
            return Err(Error::data(
                ErrorKind::OtherArm,
                "the parts were accumulated at different states",
                "accumulate all of them anew with one and the same STATE",
            ));
        }
        let fold = |(a, b): (FoldSums, &FoldSums)| FoldSums {
            normal: a.normal.plus(&b.normal),
            rows: a.rows.saturating_add(b.rows),
            precision: a.precision + b.precision,
        };
        let range = |(a, b): (&[f64; 2], &[f64; 2])| [a[0].min(b[0]), a[1].max(b[1])];
        let turns =
            |(a, b): (&Turns, &Turns)| Turns { sum: a.sum + b.sum, count: a.count + b.count };
        Ok(Self {
            state: self.state,
            files: self.files.saturating_add(other.files),
            rows: self.rows.saturating_add(other.rows),
            poses: self.poses.saturating_add(other.poses),
            flagged: self.flagged.saturating_add(other.flagged),
            folds: self.folds.into_iter().zip(&other.folds).map(fold).collect(),
            residuals: self.residuals.plus(&other.residuals),
            covered: self.covered.iter().zip(&other.covered).map(range).collect(),
            turns: self.turns.iter().zip(&other.turns).map(turns).collect(),
            points: self.points.plus(&other.points),
            frame: self.frame.plus(&other.frame),
            merged: Vec::new(),
        })
    }

    /// The same of two pieces of one file.
    ///
    /// # Errors
    /// As for [`Part::plus`].
    pub fn beside(self, other: &Self) -> Result<Self> {
        let files = self.files.max(other.files);
        Ok(Self { files, ..self.joined(other)? })
    }

    /// Equations of all rows that count.
    pub(super) fn whole(&self) -> Normal {
        let parts = self.folds.iter().map(|fold| &fold.normal);
        parts.fold(Normal::none(self.frame.pull.ncols()), |sum, part| sum.plus(part))
    }
}
