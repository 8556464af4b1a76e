use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::diagnose::outcome::{Alternative, SeparatingPose};
use crate::diagnose::policy::POLICY;
use crate::diagnose::search::Search;
use crate::diagnose::search::node::{Node, at_floor};
use crate::evaluate::residuals;
use crate::identify::{Conditions, State, folds};
use crate::model::Robot;
use crate::units::joint_to_file;

/// Explanations of the data that stay within reach of the best one.
#[must_use]
pub fn alternatives(
    search: &Search,
    robot: &Robot,
    best: &Node,
    nodes: &[Node],
) -> Vec<(Alternative, State)> {
    let names = |n: &Node| {
        let mut list: Vec<_> = n.added.iter().map(|c| (c.name(), c.joints())).collect();
        list.sort();
        list.dedup();
        list
    };
    let mine = names(best);
    let mut seen = vec![mine.clone()];
    let mut out = Vec::new();
    for node in nodes {
        let theirs = names(node);
        // More of the same is no alternative.
        let contains = mine.iter().all(|m| theirs.contains(m));
        if contains || seen.contains(&theirs) || !at_floor(node) {
            continue;
        }
        // Judged by the data alone: what a coefficient more costs is a reason to
        // prefer, not to rule out. A row that had to be flagged for it counts
        // what it would have cost at least, or a few new poses that speak
        // against an explanation would be taken for gross errors.
        let data = |n: &Node| n.misfit + n.fit.outliers.len() as f64 * POLICY.gross.powi(2);
        let worse_by = data(node) - data(best);
        if worse_by > POLICY.within_reach || node.added.len() > best.added.len() {
            continue;
        }
        seen.push(theirs.clone());
        let poses = separating(search, robot, &best.fit.fit.state, &node.fit.fit.state);
        let alternative = Alternative { effects: theirs, worse_by, separating_poses: poses };
        out.push((alternative, node.fit.fit.state.clone()));
    }
    out
}

/// Poses within limits where two explanations differ most.
fn separating(search: &Search, robot: &Robot, a: &State, b: &State) -> Vec<SeparatingPose> {
    let data = search.problem.data;
    let mut rng = ChaCha8Rng::seed_from_u64(folds::SEED);
    let ranges: Vec<[f64; 2]> =
        robot.joints.iter().zip(data.covered()).map(|(j, c)| j.limits.unwrap_or(c)).collect();
    let pose = |_| ranges.iter().map(|[low, high]| rng.random_range(*low..=*high)).collect();
    let poses: Vec<Vec<f64>> = (0..POLICY.tried).map(pose).collect();
    let tried = data.trial(&poses, &mut rng);
    let conditions = Conditions::new(&tried, robot);
    let (first, second) = (residuals(&tried, &conditions, a), residuals(&tried, &conditions, b));
    let mut order: Vec<(f64, usize)> =
        first.iter().zip(&second).map(|(a, b)| (*a - *b).norm()).zip(0..POLICY.tried).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut out: Vec<(usize, f64)> = Vec::new();
    for (difference, i) in order {
        // Not five times the same pose.
        let apart = |(j, _): &(usize, f64)| {
            let d = tried.rows[*j].q.iter().zip(&tried.rows[i].q).map(|(a, b)| (a - b).powi(2));
            d.sum::<f64>().sqrt() > POLICY.poses_apart
        };
        if out.len() < POLICY.proposed && out.iter().all(apart) {
            out.push((i, difference));
        }
    }
    let show = |(i, difference): (usize, f64)| SeparatingPose {
        joints: tried.rows[i]
            .q
            .iter()
            .zip(&robot.joints)
            .map(|(q, j)| (joint_to_file(j.link.kind, *q) * 100.0).round() / 100.0)
            .collect(),
        difference_mm: difference * 1e3,
    };
    out.into_iter().map(show).collect()
}
