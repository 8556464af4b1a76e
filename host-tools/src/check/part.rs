//! One mistake that was made in a block of the rows only.

use nalgebra::Vector3;

use super::chains::Chains;
use super::finding::{Finding, Verdict};
use super::mistake::Mistake;
use super::sample::Sample;
use super::scene::{Scene, Sight};
use super::search::{Found, Search};
use super::stray::{LEAST_OF_BASE, Seen, Stray, ranges, rms};
use super::{absorbed, hypotheses, words};
use crate::identify::rigid_transform;
use crate::model::{Measurements, Robot};
use crate::statistics::median;
use crate::units::from_mm;

/// So many rows of a block tell what is wrong in it.
const MOST_TRIED: usize = 60;

/// What may have been otherwise in a block of rows.
struct Cause {
    change: Option<Mistake>,
    /// The tracker or the arm's foot stood elsewhere as well.
    moved: bool,
    /// How far the block's rows are off then, m.
    far: Vec<f64>,
}

impl Cause {
    /// The plainest first: moved, one mistake, one mistake and moved.
    fn rank(&self) -> u8 {
        2 * u8::from(self.moved && self.change.is_some()) + u8::from(!self.moved)
    }

    /// As well as the other rows agree, but for a few.
    fn explains(&self, limit: f64) -> bool {
        let near = self.far.iter().filter(|d| **d <= limit).count();
        near as f64 >= 0.9 * self.far.len() as f64
    }

    fn words(&self, rows: &str, robot: &Robot, search: &Search) -> String {
        let elsewhere = "the tracker or the arm's foot stood elsewhere";
        let Some(change) = &self.change else {
            return format!(
                "in rows {rows} {elsewhere}: give them a station of their own in the column station"
            );
        };
        let said = words::said(robot, &search.sample.kinds, std::slice::from_ref(change));
        // Which axis has the wrong sign, a base of its own leaves open.
        let more = if self.moved && *change != Mistake::Hand { elsewhere } else { "" };
        let and = if more.is_empty() { "" } else { ", and " };
        format!("in rows {rows}: {}{and}{more}", said[0])
    }
}

impl Stray {
    /// The one mistake of these rows alone that makes them agree with the others'
    /// arm.
    pub(super) fn explain(
        &mut self,
        search: &Search,
        robot: &Robot,
        found: &Found,
        seen: &Seen,
        block: &[usize],
    ) {
        let some: Vec<usize> =
            block.iter().copied().step_by(block.len().div_ceil(MOST_TRIED)).collect();
        let part = seen.sample.only(&some);
        let others = (0..seen.far.len()).filter(|i| !block.contains(i));
        let known: Vec<usize> = others.map(|i| seen.sample.rows[i].station).collect();
        let changes = hypotheses::all(search.links).into_iter().filter(Mistake::of_data).map(Some);
        let bases: &[bool] = if block.len() < LEAST_OF_BASE { &[false] } else { &[false, true] };
        let causes = std::iter::once(None).chain(changes).flat_map(|change| {
            let (part, known) = (&part, &known);
            bases.iter().map(move |moved| {
                let moved = *moved;
                let far = left(search, found, part, change.as_ref(), (moved, known));
                far.map(|far| Cause { change: change.clone(), moved, far })
            })
        });
        let limit = seen.limit;
        let best = causes.flatten().filter(|cause| cause.explains(limit)).min_by(|a, b| {
            let middle = median(&a.far).total_cmp(&median(&b.far));
            a.rank().cmp(&b.rank()).then(middle)
        });
        let Some(cause) = best else { return };
        let rows: Vec<usize> = block.iter().map(|i| seen.rows[*i]).collect();
        let near: Vec<f64> = cause.far.iter().copied().filter(|d| *d <= limit).collect();
        self.left = rms(&near);
        self.explained = Some(cause.words(&ranges(&rows), robot, search));
        // Where the tracker moved as well, mended rows would lack a station.
        let whole = |c: &Mistake| !cause.moved && !matches!(c, Mistake::Step(_));
        self.change = cause.change.clone().filter(whole);
        self.block = rows;
    }
}

/// How far the rows of a block are off with a change undone; a station that only
/// they are of, or that has `moved`, where it fits best. `None` of too few rows.
fn left(
    search: &Search,
    found: &Found,
    part: &Sample,
    change: Option<&Mistake>,
    (moved, known): (bool, &[usize]),
) -> Option<Vec<f64>> {
    let changes: Vec<Mistake> = change.into_iter().cloned().collect();
    let scene = Scene::new(search.links, search.tool, part, &changes);
    let chains = Chains::new(&found.fitted.state);
    let mut far = Vec::new();
    for station in 0..part.stations {
        let here: Vec<&Sight> = scene.sights.iter().filter(|s| s.station == station).collect();
        let arm = |s: &&Sight| chains.of(station, s.marker).pose(&s.q).translation;
        let from: Vec<Vector3<f64>> = here.iter().map(arm).collect();
        let to: Vec<Vector3<f64>> = here.iter().map(|s| s.point).collect();
        match here.is_empty() {
            true => {}
            false if !moved && known.contains(&station) => {
                far.extend(from.iter().zip(&to).map(|(a, b)| (a - b).norm()));
            }
            false => far.extend(registered(&from, &to)?),
        }
    }
    Some(far)
}

/// Distances left after the rigid motion that most of the points agree with.
fn registered(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> Option<Vec<f64>> {
    let mut weights = vec![1.0; from.len()];
    let mut far = Vec::new();
    for _ in 0..10 {
        let pose = rigid_transform(from, to, &weights)?;
        far = from.iter().zip(to).map(|(a, b)| (pose.transform_point(a) - b).norm()).collect();
        let scale = median(&far).max(1e-9);
        weights = far.iter().map(|d| (1.0 + (d / (2.0 * scale)).powi(2)).recip()).collect();
    }
    Some(far)
}

/// A mistake that was made in some rows only: the others agree with the arm.
pub(super) fn finding(
    robot: &Robot,
    data: &Measurements,
    search: &Search,
    nothing: &Found,
    stray: Stray,
) -> Finding {
    let changes: Vec<Mistake> = stray.change.iter().cloned().collect();
    let mut said = words::said(robot, &search.sample.kinds, &changes);
    said.iter_mut().for_each(|said| said.rows = Some(ranges(&stray.block)));
    let (all, part) = (stray.of as f64, stray.block.len() as f64);
    let mixed = |left: f64| {
        let others = from_mm(stray.others_mm);
        ((part * left * left + (all - part) * others * others) / all).sqrt()
    };
    Finding {
        verdict: Verdict::Mendable,
        changes,
        said,
        equivalent: Vec::new(),
        margin: None,
        absorbed: absorbed::by_base_or_tool(search, nothing, &[]),
        rms_before: mixed(from_mm(stray.off_mm)),
        rms_after: mixed(stray.left),
        correction_before: nothing.fitted.correction,
        tool: nothing.fitted.state.markers.first().copied().unwrap_or(robot.tool),
        poses: data.poses,
        too_few: None,
        stray: Some(stray),
    }
}
