//! Some rows of many.

use std::collections::BTreeMap;

use super::Pieces;
use crate::error::Result;
use crate::model::near::cell;
use crate::model::{Measurements, Row};
use truearm::JointKind;

/// Rows of a station or marker that say where it is beyond doubt.
const LEAST: usize = 60;

/// Rows drawn from files, and how much there is in those.
pub struct Sample {
    /// The rows, in the order of the files.
    pub data: Measurements,
    /// Rows of all files.
    pub rows: usize,
    /// Poses in them.
    pub poses: usize,
}

/// Where a row is: its file, and its line or number there.
type Place = (usize, usize);

/// Rows that are drawn, and of each station and marker the first ones that are not.
#[derive(Default)]
struct Drawn {
    rows: usize,
    /// By station and marker.
    taken: BTreeMap<Place, (String, String, Row)>,
    spare: BTreeMap<(String, String), BTreeMap<Place, Row>>,
    /// A hash a pose.
    poses: Vec<u64>,
    warnings: Vec<String>,
}

impl Pieces<'_> {
    /// About so many rows, drawn by chance that is the same in every run, and some of every
    /// station and marker.
    ///
    /// # Errors
    /// As for [`Pieces::fold`].
    pub fn sample(&self, rows: usize) -> Result<Sample> {
        let share = rows as f64 / self.rows().max(1) as f64;
        let joints: Vec<JointKind> = self.robot.joints.iter().map(|j| j.link.kind).collect();
        let drawn = self
            .blocks(&|file, data| Ok(Drawn::of(file, data, (share, &joints))), &|a, b| {
                Ok(a.plus(b))
            })?;
        let Drawn { rows, mut taken, spare, poses, warnings } = drawn;
        for ((station, marker), some) in spare {
            let has = |(s, m, _): &&(String, String, Row)| (s, m) == (&station, &marker);
            let lacks = LEAST.saturating_sub(taken.values().filter(has).count());
            for (place, row) in some.into_iter().take(lacks) {
                taken.insert(place, (station.clone(), marker.clone(), row));
            }
        }
        let mut first = taken.keys().map(|(file, ..)| *file);
        let file = &self.files[first.next().unwrap_or_default()];
        let mut data =
            Measurements::drawn(&file.path, taken.into_values(), self.robot, &file.book)?;
        data.warnings.extend(warnings);
        data.warnings.sort();
        data.warnings.dedup();
        Ok(Sample { data, rows, poses: poses.len() })
    }
}

impl Drawn {
    fn of(file: usize, data: Measurements, (share, joints): (f64, &[JointKind])) -> Self {
        let mut drawn = Self { rows: data.rows.len(), warnings: data.warnings, ..Self::default() };
        let mut poses = vec![0; data.poses];
        for row in data.rows {
            poses[row.pose] = cell(&row.q, joints.iter().copied());
            let at = (file, row.line);
            let labels = (data.stations[row.station].clone(), data.markers[row.marker].clone());
            if chance(at) < share {
                drawn.taken.insert(at, (labels.0, labels.1, row));
                continue;
            }
            let spare = drawn.spare.entry(labels).or_default();
            if spare.len() < LEAST {
                spare.insert(at, row);
            }
        }
        drawn.poses = sorted(poses);
        drawn
    }

    fn plus(mut self, mut other: Self) -> Self {
        self.rows += other.rows;
        self.taken.append(&mut other.taken);
        for (labels, rows) in other.spare {
            let own = self.spare.entry(labels).or_default();
            own.extend(rows.into_iter().take(LEAST.saturating_sub(own.len())));
        }
        self.poses.append(&mut other.poses);
        self.poses = sorted(self.poses);
        let new = other.warnings.into_iter().filter(|text| !self.warnings.contains(text));
        let new: Vec<String> = new.collect();
        self.warnings.extend(new);
        self
    }
}

fn sorted(mut poses: Vec<u64>) -> Vec<u64> {
    poses.sort_unstable();
    poses.dedup();
    poses
}

/// From 0 to 1, of a place alone (the finaliser of SplitMix64).
fn chance((file, row): Place) -> f64 {
    let mut z = (file as u64).wrapping_mul(0xd1b5_4a32_d192_ed03)
        ^ (row as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
