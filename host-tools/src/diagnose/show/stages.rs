use crate::diagnose::node::{Node, fitted};
use crate::diagnose::question::Question;
use crate::error::Result;

/// The models from geometry to the final one: each adds all terms of one
/// effect, the most telling first.
///
/// # Errors
/// When an intermediate fit does not converge.
pub fn stages(q: &Question, root: &Node, best: &Node) -> Result<Vec<Node>> {
    let mut names: Vec<&'static str> = Vec::new();
    for candidate in &best.added {
        if !names.contains(&candidate.name()) {
            names.push(candidate.name());
        }
    }
    let with = |chosen: &[&str], start: &Node| {
        let added = best.added.iter().filter(|c| chosen.contains(&c.name())).cloned().collect();
        fitted(q, added, &start.fit.fit.state)
    };
    let mut out = vec![root.clone()];
    let mut chosen: Vec<&'static str> = Vec::new();
    while chosen.len() < names.len() {
        let left: Vec<_> = names.iter().filter(|n| !chosen.contains(n)).copied().collect();
        let last = &out[out.len() - 1];
        let mut next: Option<(&'static str, Node)> = None;
        for name in left {
            let trial = [chosen.as_slice(), &[name]].concat();
            let node = if trial.len() == names.len() { best.clone() } else { with(&trial, last)? };
            if next.as_ref().is_none_or(|(_, n)| node.misfit < n.misfit) {
                next = Some((name, node));
            }
        }
        let Some((name, node)) = next else { break };
        chosen.push(name);
        out.push(node);
    }
    Ok(out)
}
