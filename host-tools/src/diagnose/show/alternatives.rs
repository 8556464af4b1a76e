use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::outcome::{Alternative, SeparatingPose};
use crate::diagnose::policy::POLICY;
use crate::diagnose::question::Question;
use crate::evaluate::residuals;
use crate::identify::fit::folds;
use crate::identify::{Conditions, State};
use crate::model::{Robot, Row};
use crate::units::joint_to_file;

/// The most probable models that make other claims, fitted.
#[must_use]
pub fn alternatives(
    q: &Question,
    robot: &Robot,
    best: &Node,
    rivals: &[(Vec<Candidate>, f64)],
) -> Vec<(Alternative, State)> {
    let mine = claims(&best.added);
    let mut out: Vec<(Alternative, State)> = Vec::new();
    for (added, odds) in rivals {
        let theirs = claims(added);
        // More of the same is no alternative, but that it is late or at once.
        let more = mine.iter().all(|m| theirs.contains(m));
        let otherwise = late(&best.added).is_some() != late(added).is_some();
        if more && !(otherwise && mine == theirs) || out.len() == POLICY.alternatives {
            continue;
        }
        // What cannot be fitted is no explanation.
        let Ok(node) = fitted(q, added.clone(), &best.fit.fit.state) else { continue };
        if !node.implausible(&q.problem.conditions).is_empty() {
            continue;
        }
        let poses = match more {
            // That is told by time and not by poses.
            true => Vec::new(),
            false => separating(q, robot, &best.fit.fit.state, &node.fit.fit.state),
        };
        let alternative = Alternative {
            effects: theirs,
            time_constant_s: late(added),
            worse_by: -2.0 * odds.ln(),
            separating_poses: poses,
        };
        out.push((alternative, node.fit.fit.state));
    }
    out
}

/// Time constant with which the arm follows its temperature, s; none where it does at once.
fn late(added: &[Candidate]) -> Option<f64> {
    added.iter().map(Candidate::time_constant).find(|tau| *tau > 0.0)
}

/// Names and joints, each once.
fn claims(added: &[Candidate]) -> Vec<(&'static str, Vec<usize>)> {
    let mut list: Vec<_> = added.iter().map(|c| (c.name(), c.joints())).collect();
    list.sort();
    list.dedup();
    list
}

/// Poses within limits where two explanations differ most.
fn separating(q: &Question, robot: &Robot, a: &State, b: &State) -> Vec<SeparatingPose> {
    let data = q.problem.data;
    let mut rng = ChaCha8Rng::seed_from_u64(folds::SEED);
    let ranges: Vec<[f64; 2]> =
        robot.joints.iter().zip(data.covered()).map(|(j, c)| j.limits.unwrap_or(c)).collect();
    let pose = |_| ranges.iter().map(|[low, high]| rng.random_range(*low..=*high)).collect();
    let poses: Vec<Vec<f64>> = (0..POLICY.tried).map(pose).collect();
    let mut tried = data.trial(&poses, &mut rng);
    // Where the target is, whatever measured it.
    tried.rows.iter_mut().for_each(Row::make_point);
    let conditions = Conditions::at(&tried, robot, &a.links);
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
