//! Poses about one point: where the targets of a station lie in a cloud that is hardly larger than
//! what the arm errs by, registration turns its base by chance, and a fit from there ends where it
//! may. Several turns are tried, and the one stands from which a fit ends lowest.

use nalgebra::{Matrix3, Vector3};
use truearm::Pose;

use super::registration::register;
use crate::error::Result;
use crate::identify::fit::{Freedom, cost_at, damped};
use crate::identify::problem::{Problem, State};
use crate::model::arm::chain;
use crate::observations::kind;
use crate::statistics::median;

/// A cloud is narrow whose radius is less than so many times what registration leaves, and than so
/// much, m; medians, of which a gross error is no part. No study set them.
const HARDLY: f64 = 20.0;
const NARROW: f64 = 0.05;
/// A row so many radii away is none of the cloud.
const STRAY: f64 = 10.0;
/// Rows that turns are told by, at least and at most.
const FEWEST: usize = 4;
const ENOUGH: usize = 200;
/// Another turn has to end lower by this share: what is as good stays.
const LOWER: f64 = 0.01;

/// Where a fit of a problem begins.
///
/// # Errors
/// As for [`register`].
pub fn first(problem: &Problem, tool: Vector3<f64>) -> Result<State> {
    let mut state = register(problem.data, &problem.nominal, tool)?;
    for station in 0..state.bases.len() {
        if let Some(better) = turned(problem, &state, station) {
            state = better;
        }
    }
    Ok(state)
}

/// The state with the base of a station turned, where that is told by nothing but a fit.
fn turned(problem: &Problem, state: &State, station: usize) -> Option<State> {
    let problem = problem.clone().about(state);
    let all = problem.counted();
    let mut rows: Vec<usize> =
        all.iter().copied().step_by(all.len().div_ceil(ENOUGH).max(1)).collect();
    let cloud = Cloud::of(&problem, state, &rows, station)?;
    if cloud.radius > NARROW || cloud.radius > HARDLY * cloud.left {
        return None;
    }
    rows.retain(|row| !cloud.stray.contains(row));
    let ended = |start: &State| {
        let fit = damped(&problem, &rows, None, start, Freedom::All(1.0)).ok()?;
        Some(cost_at(&problem, &rows, &fit.state, 1.0))
    };
    let here = ended(state).unwrap_or(f64::INFINITY);
    let tried = turns().into_iter().skip(1).filter_map(|turn| {
        let mut start = state.clone();
        let base = &state.bases[station];
        let rotation = turn * base.rotation;
        // The middle of what is modelled stays on the middle of what was measured.
        let middle = base.inverse().transform_point(&cloud.modelled);
        let translation = cloud.measured - rotation * middle;
        start.bases[station] = Pose { rotation, translation };
        Some((ended(&start)?, start))
    });
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 < (1.0 - LOWER) * here).then_some(best.1)
}

/// Points of a station and where a state has them.
struct Cloud {
    measured: Vector3<f64>,
    modelled: Vector3<f64>,
    /// Medians, m: of the distance from the middle, and of what the state leaves.
    radius: f64,
    left: f64,
    /// Rows far out of it: gross errors, which no turn may go by.
    stray: Vec<usize>,
}

impl Cloud {
    /// `None` where rows of the station measured something else than points, or are few.
    fn of(problem: &Problem, state: &State, rows: &[usize], station: usize) -> Option<Self> {
        let base = state.bases[station];
        let seen = |index: &usize| {
            let row = &problem.data.rows[*index];
            let chain = chain(&state.links, base, state.markers[row.marker]);
            Some((*index, kind(row).point(row)?, chain.pose(&row.q).translation))
        };
        let own = rows.iter().filter(|row| problem.data.rows[**row].station == station);
        let mut seen: Vec<_> = own.map(seen).collect::<Option<_>>()?;
        let axis = |axis: usize| median(&seen.iter().map(|s| s.1[axis]).collect::<Vec<f64>>());
        let middle = Vector3::new(axis(0), axis(1), axis(2));
        let median_of = |of: &mut dyn Iterator<Item = f64>| median(&of.collect::<Vec<f64>>());
        let radius = median_of(&mut seen.iter().map(|s| (s.1 - middle).norm()));
        let left = median_of(&mut seen.iter().map(|s| (s.1 - s.2).norm()));
        let is_stray = |point: &Vector3<f64>| (point - middle).norm() > STRAY * radius;
        let stray = seen.iter().filter(|s| is_stray(&s.1)).map(|s| s.0).collect();
        seen.retain(|s| !is_stray(&s.1));
        if seen.len() < FEWEST {
            return None;
        }
        let each = 1.0 / seen.len() as f64;
        let measured = seen.iter().map(|s| s.1).sum::<Vector3<f64>>() * each;
        let modelled = seen.iter().map(|s| s.2).sum::<Vector3<f64>>() * each;
        Some(Self { measured, modelled, radius, left, stray })
    }
}

/// The 24 turns of a cube, none first: no turn is farther than 63 degrees from one of them.
fn turns() -> Vec<Matrix3<f64>> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let signed: Vec<Vector3<f64>> = axes.iter().flat_map(|a| [*a, -*a]).collect();
    let of = |x: &Vector3<f64>| {
        let x = *x;
        let across = signed.iter().filter(move |y| x.dot(y) == 0.0);
        across.map(move |y| Matrix3::from_columns(&[x, *y, x.cross(y)])).collect::<Vec<_>>()
    };
    signed.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_24_turns_and_none_is_first() {
        let all = turns();
        assert_eq!((all.len(), all[0]), (24, Matrix3::identity()));
        for (k, turn) in all.iter().enumerate() {
            assert!((turn.determinant() - 1.0).abs() < 1e-12);
            assert!(all[..k].iter().all(|other| other != turn));
        }
    }
}
