//! Which configuration a path of poses begins in, where nobody says.

use std::f64::consts::TAU;

use truearm::JointKind;

use super::inverse::{Found, Inverse};
use crate::model::{Row, Target};

/// Rows ahead that a configuration is tried on.
const AHEAD: usize = 50;
/// Configurations that are tried.
const TRIED: usize = 8;
/// Joints nearer to each other than this are one configuration, rad or m.
const ALIKE: f64 = 0.1;
/// A joint that far beyond a range is at its end, rad or m: less than what counts as
/// reached, and more than rounding.
const AT_END: f64 = 1e-7;

impl Inverse<'_> {
    /// The configuration of a first row from which most of the rows ahead are within the
    /// preferred ranges; of several the one farthest within, or least outside. None
    /// where nothing is preferred, or nothing reaches.
    pub(super) fn choose(&self, ahead: &[(&Row, &Target)]) -> Option<Found> {
        let (row, target) = *ahead.first()?;
        if self.preferred.iter().all(Option::is_none) {
            return None;
        }
        let within = self.spread(|j| self.preferred[j].unwrap_or_else(|| self.usual(j)));
        let anywhere = self.anywhere();
        let found = within.iter().chain(&anywhere).filter_map(|start| {
            let mut found = self.solve(row, target, start);
            (0..found.joints.len()).for_each(|j| found.joints[j] = self.turned(j, found.joints[j]));
            let found = self.at_ends(row, target, found);
            found.is_reached().then(|| (self.inside(&found.joints), found))
        });
        let mut found: Vec<(f64, Found)> = found.collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut tried: Vec<(usize, Found)> = Vec::new();
        for (_, found) in found {
            let apart = |(_, other): &(usize, Found)| {
                found.joints.iter().zip(&other.joints).any(|(a, b)| (a - b).abs() > ALIKE)
            };
            if tried.len() < TRIED && tried.iter().all(apart) {
                tried.push((self.rows_inside(ahead, &found), found));
            }
        }
        let most = tried.iter().map(|t| t.0).max()?;
        tried.into_iter().find(|t| t.0 == most).map(|(_, found)| found)
    }

    /// How many of the rows ahead are within, followed from the first.
    fn rows_inside(&self, ahead: &[(&Row, &Target)], first: &Found) -> usize {
        let mut last = first.joints.clone();
        let mut count = usize::from(self.inside(&last) >= 0.0);
        for (row, target) in ahead.iter().skip(1).take(AHEAD) {
            let next = self.solve(row, target, &last);
            if next.is_reached() {
                last = self.at_ends(row, target, next).joints;
                count += usize::from(self.inside(&last) >= 0.0);
            }
        }
        count
    }

    /// With joints that are beyond the end of a preferred range by a rounding at it.
    pub(super) fn at_ends(&self, row: &Row, target: &Target, found: Found) -> Found {
        let mut joints = found.joints.clone();
        for (q, range) in joints.iter_mut().zip(&self.preferred) {
            let Some([low, high]) = *range else { continue };
            if *q < low - AT_END || *q > high + AT_END {
                continue;
            }
            *q = q.max(low).min(high);
        }
        if joints == found.joints {
            return found;
        }
        let moved = self.left_at(row, target, joints);
        if moved.is_reached() { moved } else { found }
    }

    /// The same angle whole turns away, within the limits, nearest to the middle of
    /// what is preferred.
    fn turned(&self, j: usize, q: f64) -> f64 {
        let revolute = self.forward.kinds()[j] == JointKind::Revolute;
        let Some([low, high]) = self.preferred[j].filter(|_| revolute) else { return q };
        let turns = (((low + high) / 2.0 - q) / TAU).round();
        let moved = q + turns * TAU;
        let [low, high] = self.limits[j];
        if (low..=high).contains(&moved) { moved } else { q }
    }

    /// How far joints are within what is preferred, as a share of the half ranges; less
    /// than zero where one is outside.
    fn inside(&self, q: &[f64]) -> f64 {
        let share = |(q, range): (&f64, &Option<[f64; 2]>)| {
            let [low, high] = (*range)?;
            let half = (high - low) / 2.0;
            // A joint that stood still has a range of one value.
            Some((*q - low).min(high - *q) / half.max(f64::MIN_POSITIVE))
        };
        q.iter().zip(&self.preferred).filter_map(share).fold(1.0, f64::min)
    }
}
