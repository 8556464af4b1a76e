//! The search where there are many rows.

use super::Search;
use super::node::Node;
use crate::diagnose::candidates::{Candidate, arm_terms};
use crate::diagnose::policy::POLICY;
use crate::error::Result;

impl Search<'_> {
    /// With many rows: the best few of each round together, then what became
    /// needless is dropped.
    pub(super) fn rounds(&self, root: Node, progress: &dyn Fn()) -> Result<Vec<Node>> {
        let mut node = root.clone();
        let mut refused: Vec<Candidate> = Vec::new();
        for _ in 0..POLICY.rounds {
            let mut found = self.promising(&node, 4 * POLICY.together);
            found.retain(|f| !refused.iter().any(|r| r.excludes(&f.0)));
            let Some(best) = found.first().map(|f| f.2).filter(|gain| *gain > POLICY.worth) else {
                break;
            };
            let mut added = node.added.clone();
            let mut places: Vec<(Vec<usize>, f64)> = Vec::new();
            for (candidate, _, gain) in found {
                // Neighbours in order or joint explain the same: one a round.
                let order = candidate.terms[0].order().unwrap_or(0.0);
                let joints = candidate.joints();
                let near = |(j, o): &(Vec<usize>, f64)| {
                    *j == joints && (o - order).abs() < POLICY.orders_apart
                };
                let with = arm_terms(&added) + arm_terms(std::slice::from_ref(&candidate));
                let fits = with <= self.most_terms.max(POLICY.followed_terms);
                if gain > POLICY.share_of_best * best
                    && fits
                    && places.len() < POLICY.together
                    && !places.iter().any(near)
                {
                    places.push((joints, order));
                    added.push(candidate);
                }
            }
            if added.len() == node.added.len() {
                break;
            }
            let Ok(next) = self.fit_near(added, &node.fit.fit.state, Some(&node.fit)) else {
                break;
            };
            progress();
            let bad = next.implausible();
            if !bad.is_empty() {
                // Without what cannot be, this round again.
                let kept = |c: &Candidate| !bad.contains(c);
                node.added.iter().filter(|c| !kept(c)).for_each(|c| refused.push(c.clone()));
                let added = node.added.iter().filter(|c| kept(c)).cloned().collect();
                refused.extend(bad.clone());
                node = self.fit_near(added, &node.fit.fit.state, Some(&node.fit))?;
                continue;
            }
            if next.worth(&node) < POLICY.worth {
                break;
            }
            node = next;
        }
        let best = self.pruned(node)?;
        Ok(vec![best, root])
    }
}
