//! Whether flagged rows are gross errors, each of its own cause, or structure.

use super::chi_square::chi_square;
use super::node::Node;
use super::policy::POLICY;
use crate::identify::Problem;
use crate::model::Row;
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

/// Whether poses of flagged rows are neighbours more often than chance has them: in the order
/// of measurement, by a joint's value or by where the arm was. What several readings of one
/// pose share is one mistake.
fn together(problem: &Problem, node: &Node) -> bool {
    let data = problem.data;
    let pose = |row: usize| data.rows[row].pose;
    let mut flagged = vec![false; data.poses];
    node.fit.outliers.iter().for_each(|o| flagged[pose(o.row)] = true);
    let own = node.fit.outliers.iter().map(|o| o.row);
    let mut rows: Vec<usize> = own.chain(node.fit.kept.iter().copied()).collect();
    rows.sort_by_key(|row| pose(*row));
    rows.dedup_by_key(|row| pose(*row));
    let few = rows.iter().filter(|row| flagged[pose(**row)]).count() as f64;
    let at = problem.linearise(&node.fit.fit.state);
    let mut orders: Vec<Vec<f64>> = Vec::new();
    let mut by = |of: &dyn Fn(usize, &Row) -> f64| {
        orders.push((0..data.rows.len()).map(|row| of(row, &data.rows[row])).collect());
    };
    let place = data.places();
    by(&|row, _| place[row]);
    (0..problem.nominal.len()).for_each(|joint| by(&|_, row| row.q[joint]));
    (0..3).for_each(|axis| by(&|row, _| at.target(row).0[axis]));
    let expected = few * (few - 1.0) / rows.len() as f64;
    orders.iter().any(|order| {
        rows.sort_by(|a, b| order[*a].total_cmp(&order[*b]).then(a.cmp(b)));
        let pairs = rows.windows(2).filter(|pair| pair.iter().all(|row| flagged[pose(*row)]));
        let pairs = pairs.count();
        // As many as that or more.
        let chance = 1.0 - chi_square(2.0 * expected, 2 * pairs);
        pairs > 0 && chance * (orders.len() as f64) < POLICY.significant
    })
}

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
