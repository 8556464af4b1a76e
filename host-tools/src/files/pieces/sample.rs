//! Some rows of many.

use std::collections::BTreeMap;

use super::{Pieces, Place, twice};
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
    /// Rows that stand in them before and do not count.
    pub twice: usize,
}

/// Rows that are drawn, and of each station and marker the first ones that are not.
#[derive(Default)]
struct Drawn {
    rows: usize,
    /// By station and marker.
    taken: BTreeMap<Place, (String, String, Row)>,
    spare: BTreeMap<(String, String), BTreeMap<Place, Row>>,
    /// A hash a row, that of its pose, sorted.
    cells: Vec<u64>,
    warnings: Vec<String>,
}

impl Pieces<'_> {
    /// About so many rows, drawn by chance that is the same in every run, and some of every
    /// station and marker. From then on what stands several times counts once.
    ///
    /// # Errors
    /// As for [`Pieces::fold`].
    pub fn sample(&mut self, rows: usize) -> Result<Sample> {
        let share = rows as f64 / self.rows().max(1) as f64;
        let kinds = self.kinds();
        let draw = |place, data| Ok(Some(Drawn::of(place, data, (share, &kinds))));
        let drawn = self.blocks(&draw, &|a, b| Ok(a.plus(b)))?;
        let Drawn { rows, mut taken, spare, mut cells, warnings } = drawn;
        let repeated = twice::repeated(&cells);
        cells.dedup();
        let poses = cells.len();
        drop(cells);
        for ((station, marker), some) in spare {
            let has = |(s, m, _): &&(String, String, Row)| (s, m) == (&station, &marker);
            let lacks = LEAST.saturating_sub(taken.values().filter(has).count());
            for (place, row) in some.into_iter().take(lacks) {
                taken.insert(place, (station.clone(), marker.clone(), row));
            }
        }
        let mut of: Vec<usize> = taken.keys().map(|place| place.file).collect();
        let file = &self.files[of.first().copied().unwrap_or_default()];
        let mut data =
            Measurements::drawn(&file.path, taken.into_values(), self.robot, &file.book)?;
        if data.rows.len() < rows {
            let drawn = format!(" (of {} rows drawn)", data.rows.len());
            data.warnings.iter_mut().for_each(|text| *text += &drawn);
        }
        data.warnings.extend(warnings);
        data.warnings.dedup();
        let once = data.distinct();
        let mut all: Vec<Option<Row>> = data.rows.into_iter().map(Some).collect();
        data.rows = once.iter().filter_map(|row| all[*row].take()).collect();
        of = once.iter().map(|row| of[*row]).collect();
        let first = |file: usize| of.iter().position(|own| *own == file).filter(|row| *row > 0);
        let behind = self.files.iter().enumerate();
        let behind = behind.filter_map(|(k, file)| Some((file.path.clone(), first(k)?)));
        data.behind = behind.collect();
        let twice = self.find_twice(&repeated)?;
        Ok(Sample { data, rows, poses, twice })
    }

    /// What the joints of the arm are.
    pub(super) fn kinds(&self) -> Vec<JointKind> {
        self.robot.joints.iter().map(|joint| joint.link.kind).collect()
    }
}

impl Drawn {
    fn of(first: Place, data: Measurements, (share, kinds): (f64, &[JointKind])) -> Self {
        let mut drawn = Self { rows: data.rows.len(), warnings: data.warnings, ..Self::default() };
        for (k, row) in data.rows.into_iter().enumerate() {
            drawn.cells.push(cell(&row.q, kinds.iter().copied()));
            let at = first.on(k);
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
        drawn.cells.sort_unstable();
        drawn
    }

    fn plus(mut self, mut other: Self) -> Self {
        self.rows += other.rows;
        self.taken.append(&mut other.taken);
        for (labels, rows) in other.spare {
            let own = self.spare.entry(labels).or_default();
            own.extend(rows.into_iter().take(LEAST.saturating_sub(own.len())));
        }
        self.cells = twice::merged(self.cells, other.cells);
        let new = other.warnings.into_iter().filter(|text| !self.warnings.contains(text));
        let new: Vec<String> = new.collect();
        self.warnings.extend(new);
        self
    }
}

/// From 0 to 1, of a place alone (the finaliser of SplitMix64).
fn chance(Place { file, piece, row }: Place) -> f64 {
    let mut z = (file as u64).wrapping_mul(0xd1b5_4a32_d192_ed03)
        ^ (piece as u64).wrapping_add(1).wrapping_mul(0x8cb9_2ba7_2f3d_8dd7)
        ^ row.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
