//! Gravity torques of an arm that nobody weighed: the first moments of its links,
//! found together with the springs that they bend.
//!
//! Assumed masses give torques of about the right shape. Where springs were found
//! with them, what is left has the shape of what the masses were wrong by: a
//! torque is linear in the first moments of all that follows the joint, so that
//! they are unknowns of the fit like any other, held near what was assumed. Their
//! common size is known from that alone: the springs' coefficients take it up.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use truearm::effects::{Effect, Term};

use super::candidates::Candidate;
use super::node::{Node, fitted};
use super::question::Question;
use crate::error::Result;
use crate::identify::{Conditions, Problem, Surroundings, Unknown};
use crate::model::arm::{Derivatives, RowInputs};
use crate::model::{ModelTerm, Robot};

/// Rounds of fitting springs and moments in turn.
const ROUNDS: usize = 4;
/// Prior of a moment about what was assumed, over the sum of all of them: at 1 an
/// eccentricity of joint 2 took up what was left of a shipped set's moments.
const SHARE: f64 = 2.0;
/// Precision that keeps unknowns without a prior where they are, in units.
const HELD: f64 = 1e-8;

/// The same problem with the loads of a robot.
#[must_use]
pub fn loaded_by<'a>(problem: &Problem<'a>, robot: &Robot) -> Problem<'a> {
    let conditions = Arc::new(Conditions::new(problem.data, robot));
    Problem { conditions, ..problem.clone() }
}

/// The robot with the moments of its links fitted beside the springs of a model;
/// `None` where the model has none.
///
/// # Errors
/// When a fit does not converge.
pub fn adapted(q: &Question, robot: &Robot, found: &Node) -> Result<Option<Robot>> {
    let springs = |c: &&Candidate| {
        [Effect::JointCompliance, Effect::BaseCompliance].iter().any(|e| e.name() == c.name())
    };
    let springs: Vec<Candidate> = found.added.iter().filter(springs).cloned().collect();
    if springs.is_empty() {
        return Ok(None);
    }
    let assumed = robot;
    let mut robot = robot.clone();
    let mut state = found.fit.fit.state.clone();
    for _ in 0..ROUNDS {
        let problem = loaded_by(q.problem, &robot);
        let node = fitted(&Question { problem: &problem, ..*q }, springs.clone(), &state)?;
        let step = step(&problem, [assumed, &robot], &node, q.flags.lambda);
        state = node.fit.fit.state;
        let Some(step) = step else { break };
        for (link, moment) in robot.links.iter_mut().zip(step.chunks_exact(2)) {
            link.com.x += moment[0] / link.mass;
            link.com.y += moment[1] / link.mass;
        }
    }
    robot.warnings.push(format!(
        "{}: the first moments of its links were fitted beside the springs",
        robot.path.display()
    ));
    Ok(Some(robot))
}

/// What to add to the moments about x and y of each link, kg m, that are held near
/// those of the first robot.
fn step(
    problem: &Problem,
    [assumed, robot]: [&Robot; 2],
    node: &Node,
    lambda: f64,
) -> Option<Vec<f64>> {
    let terms: Vec<Term<f64>> = node.fit.fit.state.terms.iter().filter_map(of_arm).collect();
    let problem = problem.with_terms(node.fit.fit.state.terms.len());
    let turned = turned(&problem, robot);
    let at = problem.linearise(&node.fit.fit.state);
    let beside = |row: usize, d: &Derivatives| {
        let q = &problem.data.rows[row].q;
        let here = &problem.conditions.rows[row];
        let column = |there: &Vec<RowInputs>| {
            let of = |term: &Term<f64>| {
                let by = there[row].basis(q, term) - here.basis(q, term);
                d.column(term, by, &problem.nominal) * term.coefficient
            };
            terms.iter().map(of).sum()
        };
        turned.iter().map(column).collect()
    };
    let unknowns = problem.unknowns.list();
    let (p, all) = (unknowns.len(), unknowns.len() + turned.len());
    let mut h = DMatrix::<f64>::zeros(all, all);
    let mut g = DVector::<f64>::zeros(all);
    for row in &node.fit.kept {
        let e = at.equations_beside(*row, &beside);
        h += e.block.tr_mul(&e.block);
        g += e.block.tr_mul(&DVector::from_column_slice(&e.rhs));
    }
    let size: f64 = assumed.links.iter().map(|l| l.mass * l.com.norm()).sum();
    let precision = (SHARE * size).powi(-2);
    for k in 0..p {
        h[(k, k)] += if matches!(unknowns[k], Unknown::Link(..)) { lambda } else { HELD };
    }
    for k in 0..turned.len() {
        let of = |robot: &Robot| robot.links[k / 2].mass * robot.links[k / 2].com[k % 2];
        h[(p + k, p + k)] += precision;
        g[p + k] -= precision * (of(robot) - of(assumed));
    }
    let solved = h.cholesky()?.solve(&g);
    Some(solved.rows(p, turned.len()).iter().copied().collect())
}

/// What every row is like with one more kg m about x and y of each link.
fn turned(problem: &Problem, robot: &Robot) -> Vec<Vec<RowInputs>> {
    let of = |k: usize| {
        let mut other = robot.clone();
        let link = &mut other.links[k / 2];
        link.com[k % 2] += 1.0 / link.mass;
        let loads = Surroundings::new(&other);
        problem.data.rows.iter().map(|row| loads.inputs(row, &row.q)).collect()
    };
    (0..2 * robot.links.len()).map(of).collect()
}

fn of_arm(term: &ModelTerm) -> Option<Term<f64>> {
    if let ModelTerm::Arm(term) = term { Some(*term) } else { None }
}
