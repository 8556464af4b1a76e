//! The rows that hypotheses are tried on: points, with the joints of the rows
//! before and after, should the file be out of step.

use nalgebra::Vector3;
use truearm::JointKind;

use crate::model::Measurements;
use crate::observations::kind;

/// So many rows tell a gross mistake from a sound file; more only cost time.
const MOST_ROWS: usize = 100;
/// A base has six unknowns, three points nine equations.
const LEAST_OF_STATION: usize = 3;
/// Fewer points agree with nearly any arm: base and tool alone are nine unknowns.
const LEAST_ROWS: usize = 6;
/// Standard deviations that the noise of two points hardly goes beyond: 4 of each.
const STILL: f64 = 8.0;

/// Some rows of a file that measured points.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    /// Kinds of the joints.
    pub kinds: Vec<JointKind>,
    /// How many stations the file has.
    pub stations: usize,
    /// How many markers the file has.
    pub markers: usize,
    /// Smallest standard deviation that a row states, m.
    pub sigma: f64,
    /// The rows.
    pub rows: Vec<SampledRow>,
}

/// A row and its neighbours.
#[derive(Debug, Clone)]
pub(super) struct SampledRow {
    /// Joint values of the row before, of this one and of the one after, rad or m.
    pub q: [Vec<f64>; 3],
    /// The point in the tracker frame, m.
    pub point: Vector3<f64>,
    /// Index of the station.
    pub station: usize,
    /// Index of the marker.
    pub marker: usize,
}

impl Sample {
    /// Rows evenly out of the whole file; its first and last lack a neighbour.
    ///
    /// # Errors
    /// Too few points, in words.
    pub fn of(data: &Measurements, kinds: Vec<JointKind>) -> Result<Self, String> {
        let all = &data.rows;
        let inner = 1..all.len().saturating_sub(1);
        let usable: Vec<usize> =
            inner.filter(|i| kind(&all[*i]).point(&all[*i]).is_some()).collect();
        let of = |s: usize| usable.iter().filter(|i| all[**i].station == s).count();
        let counts: Vec<usize> = (0..data.stations.len()).map(of).collect();
        let usable: Vec<usize> =
            usable.into_iter().filter(|i| counts[all[*i].station] >= LEAST_OF_STATION).collect();
        if usable.len() < LEAST_ROWS {
            let is_point = |row: &&crate::model::Row| kind(row).point(row).is_some();
            let points = all.iter().filter(is_point).count();
            let least = LEAST_ROWS + 2;
            let others = all.len() - points;
            let why = if points >= least {
                format!(", as {LEAST_OF_STATION} of a station are the least that count")
            } else if others > 0 {
                format!(" beside {others} rows of other kinds, which check does not look at")
            } else {
                String::new()
            };
            return Err(format!(
                "too few points, {points}{why}; at least {least} are needed, better 50"
            ));
        }
        let count = usable.len().min(MOST_ROWS);
        let picked = (0..count).map(|k| usable[k * usable.len() / count]);
        let rows = picked.map(|i| SampledRow {
            q: [i - 1, i, i + 1].map(|i| all[i].q.clone()),
            point: all[i].measured.point(),
            station: all[i].station,
            marker: all[i].marker,
        });
        Ok(Self {
            rows: rows.collect(),
            kinds,
            stations: data.stations.len(),
            markers: data.markers.len(),
            sigma: all.iter().map(|row| row.sigma).fold(f64::INFINITY, f64::min),
        })
    }

    /// All points of a file, beside them their rows; of stations that this sample
    /// has rows of.
    pub fn whole(data: &Measurements, known: &Self) -> (Self, Vec<usize>) {
        let all = &data.rows;
        let usable = |i: &usize| {
            kind(&all[*i]).point(&all[*i]).is_some()
                && known.rows.iter().any(|row| row.station == all[*i].station)
        };
        let rows: Vec<usize> = (0..all.len()).filter(usable).collect();
        let last = all.len().saturating_sub(1);
        let row = |i: &usize| SampledRow {
            q: [i.saturating_sub(1), *i, (i + 1).min(last)].map(|i| all[i].q.clone()),
            point: all[*i].measured.point(),
            station: all[*i].station,
            marker: all[*i].marker,
        };
        (Self { rows: rows.iter().map(row).collect(), ..known.clone() }, rows)
    }

    /// Whether no point is off another by more than noise.
    #[must_use]
    pub fn stands_still(&self) -> bool {
        let first = self.rows.first().map_or_else(Vector3::zeros, |row| row.point);
        self.rows.iter().all(|row| (row.point - first).norm() <= STILL * self.sigma)
    }

    /// Some of the rows.
    pub fn only(&self, rows: &[usize]) -> Self {
        Self { rows: rows.iter().map(|i| self.rows[*i].clone()).collect(), ..self.clone() }
    }

    /// At most so many of the rows, evenly.
    #[must_use]
    pub fn thinned(&self, most: usize) -> Self {
        let count = self.rows.len().min(most);
        let rows = (0..count).map(|k| self.rows[k * self.rows.len() / count].clone());
        Self { rows: rows.collect(), ..self.clone() }
    }
}
