//! The best explanation that a controller has room for.

use super::Search;
use super::node::Node;
use crate::diagnose::candidates::{arm_terms, of_arm};
use crate::diagnose::policy::POLICY;
use crate::error::Result;

impl Search<'_> {
    /// An explanation with no more terms of the arm than asked for: what
    /// matters least goes, then what is left out is exchanged for what is in
    /// as long as that explains more.
    ///
    /// # Errors
    /// When a fit does not converge.
    pub fn within(&self, node: Node) -> Result<Node> {
        if arm_terms(&node.added) <= self.most_terms {
            return Ok(node);
        }
        let mut best = self.cut(node)?;
        for _ in 0..POLICY.exchanges {
            let found = self.promising(&best, 1);
            let Some((candidate, ..)) = found.into_iter().next() else { break };
            let added = [best.added.as_slice(), &[candidate]].concat();
            let Ok(more) = self.fit_near(added, &best.fit.fit.state, Some(&best.fit)) else {
                break;
            };
            let next = self.cut(more)?;
            if next.worth(&best) < POLICY.hint {
                break;
            }
            best = next;
        }
        Ok(best)
    }

    /// Drops what cannot be and, one after another, the additions that explain
    /// least a term.
    fn cut(&self, mut node: Node) -> Result<Node> {
        loop {
            let bad = node.implausible();
            let over = arm_terms(&node.added) > self.most_terms;
            let worth = |k: &usize| self.wald(&node, *k) / of_arm(&node.added[*k]) as f64;
            let places = (0..node.added.len()).filter(|k| of_arm(&node.added[*k]) > 0);
            let least = places.min_by(|a, b| worth(a).total_cmp(&worth(b))).filter(|_| over);
            let mut added = node.added.clone();
            if !bad.is_empty() {
                added.retain(|candidate| !bad.contains(candidate));
            } else if let Some(least) = least {
                added.remove(least);
            } else {
                return Ok(node);
            }
            node = self.fit_near(added, &node.fit.fit.state, Some(&node.fit))?;
        }
    }
}
