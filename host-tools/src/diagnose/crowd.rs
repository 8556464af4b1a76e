//! Whether flagged rows are gross errors, each of its own cause, or structure.

use super::chi_square::chi_square;
use super::node::Node;
use super::policy::POLICY;
use crate::identify::Problem;
use crate::model::arm::Derivatives;

/// Whether more rows are flagged than can be gross errors: a few always may, more only where
/// nothing that was recorded has them together, many only where no slip of a joint explains
/// them.
#[must_use]
pub fn crowded(problem: &Problem, node: &Node) -> bool {
    let flagged = node.fit.outliers.len() as f64;
    let rows = flagged + node.fit.kept.len() as f64;
    if flagged <= POLICY.crowd_rows {
        return false;
    }
    flagged > POLICY.scattered_share * rows
        || together(problem, node)
        || (flagged > POLICY.crowd_share * rows && slipped(problem, node).is_some())
}

/// Whether flagged stands of the arm are neighbours more often than chance has them in the
/// order of measurement, or flagged poses by a joint's value or by where the arm was. What
/// several readings of one stand share is one mistake.
fn together(problem: &Problem, node: &Node) -> bool {
    let data = problem.data;
    let mut flagged = vec![false; data.rows.len()];
    node.fit.outliers.iter().for_each(|o| flagged[o.row] = true);
    let own = node.fit.outliers.iter().map(|o| o.row);
    let rows: Vec<usize> = own.chain(node.fit.kept.iter().copied()).collect();
    let place = data.places();
    let at = problem.linearise(&node.fit.fit.state);
    let tests = (1 + problem.nominal.len() + AXES) as f64;
    // An order's units, each flagged or not.
    let more_than_chance = |units: &[bool]| {
        let few = units.iter().filter(|flagged| **flagged).count() as f64;
        let expected = few * (few - 1.0) / units.len() as f64;
        let pairs = units.windows(2).filter(|pair| pair[0] && pair[1]).count();
        // As many as that or more.
        let chance = 1.0 - chi_square(2.0 * expected, 2 * pairs);
        pairs > 0 && chance * tests < POLICY.significant
    };
    let pose = |row: &usize| data.rows[*row].pose;
    let any = |rows: &[usize]| rows.iter().any(|row| flagged[*row]);
    let mut stands = rows;
    stands.sort_by(|a, b| place[*a].total_cmp(&place[*b]).then(a.cmp(b)));
    let in_turn: Vec<bool> = stands.chunk_by(|a, b| pose(a) == pose(b)).map(any).collect();
    let mut poses = stands;
    poses.sort_by_key(pose);
    let poses: Vec<(usize, bool)> =
        poses.chunk_by(|a, b| pose(a) == pose(b)).map(|own| (own[0], any(own))).collect();
    let targets: Vec<_> = poses.iter().map(|(row, _)| at.target(*row).0).collect();
    let by = |of: &dyn Fn(usize) -> f64| {
        let mut order: Vec<usize> = (0..poses.len()).collect();
        order.sort_by(|a, b| of(*a).total_cmp(&of(*b)).then(a.cmp(b)));
        more_than_chance(&order.iter().map(|k| poses[*k].1).collect::<Vec<_>>())
    };
    more_than_chance(&in_turn)
        || (0..problem.nominal.len()).any(|joint| by(&|k| data.rows[poses[k].0].q[joint]))
        || (0..AXES).any(|axis| by(&|k| targets[k][axis]))
}

/// Of the place of a target.
const AXES: usize = 3;

/// The one shift of a joint that explains flagged rows: its share of their residuals, the
/// joint and the shift, rad or m.
#[must_use]
pub fn slipped(problem: &Problem, root: &Node) -> Option<(f64, usize, f64)> {
    let (at, outliers) = (problem.linearise(&root.fit.fit.state), &root.fit.outliers);
    let fitted = |joint: usize| {
        let kind = problem.nominal[joint].kind;
        let moved = |_: usize, d: &Derivatives| vec![*d.links[joint].joint(kind)];
        let (mut cc, mut cr, mut rr) = (0.0, 0.0, 0.0);
        for outlier in outliers {
            let e = at.equations_beside(outlier.row, &moved);
            let column = e.block.column(e.block.ncols() - 1);
            let residual = e.scaled(&outlier.residual);
            cc += column.norm_squared();
            cr += column.dot(&residual.column());
            rr += residual.norm_squared();
        }
        // A joint that moves none of them explains nothing.
        if cc * rr > 0.0 { (cr * cr / (cc * rr), joint, cr / cc) } else { (0.0, joint, 0.0) }
    };
    let best = (0..problem.nominal.len()).map(fitted).max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|best| best.0 > POLICY.slipped)
}
