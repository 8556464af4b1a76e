//! Sums of columns beside those of the unknowns.

use nalgebra::DMatrix;

use crate::identify::problem::accumulate::{CHUNK, tree};
use crate::identify::{Beside as Columns, Findings, Problem, State};

/// A fit to some rows.
#[derive(Clone, Copy)]
pub struct Fitted<'a> {
    /// Of as many terms as the state has.
    pub problem: &'a Problem<'a>,
    /// Where it ended.
    pub state: &'a State,
    /// Rows that were kept.
    pub rows: &'a [usize],
}

/// Sums over the rows of a fit, in units of their equations.
pub struct Beside {
    /// The columns beside the unknowns' with those, unknowns x columns.
    pub coupled: DMatrix<f64>,
    /// With each other.
    pub own: DMatrix<f64>,
}

impl<'a> Fitted<'a> {
    /// Of what was found.
    #[must_use]
    pub fn of(findings: &'a Findings) -> Self {
        let found = &findings.found;
        Self { problem: findings.problem, state: &found.fit.state, rows: &found.robust.kept }
    }

    /// Of `(unknowns, more)` columns.
    #[must_use]
    pub fn beside(&self, columns: &Columns, (unknowns, more): (usize, usize)) -> Beside {
        let at = self.problem.linearise(self.state);
        let leaf = |rows: &[usize]| {
            let mut sums =
                Beside { coupled: DMatrix::zeros(unknowns, more), own: DMatrix::zeros(more, more) };
            for row in rows {
                let e = at.equations_beside(*row, columns);
                let block = e.block.columns(unknowns, more);
                sums.coupled += e.block.columns(0, unknowns).tr_mul(&block);
                sums.own += block.tr_mul(&block);
            }
            sums
        };
        tree(self.rows, CHUNK, &leaf, &|a: Beside, b: Beside| Beside {
            coupled: a.coupled + b.coupled,
            own: a.own + b.own,
        })
    }
}
