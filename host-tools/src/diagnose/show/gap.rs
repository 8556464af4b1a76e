use rayon::prelude::*;

use super::stages::{stages, without_each};
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::outcome::{GapRow, Rms};
use crate::diagnose::policy::POLICY;
use crate::diagnose::question::Question;
use crate::diagnose::weigh::{Stage, with_curves};
use crate::error::Result;
use crate::evaluate::{own_evidence, residuals};
use crate::identify::cross_validation::Parts;
use crate::identify::fit::folds::Fold;
use crate::identify::{Noise, Problem, State, in_deviations};
use crate::model::{CURVE, ErrorCurve, Measurements, Robot};
use crate::observations::Residual;
use crate::statistics::Stats;

/// Held-out judgement of models.
#[derive(Clone, Copy)]
pub struct Show<'a> {
    /// What was asked.
    pub question: &'a Question<'a>,
    /// The same without error curves.
    pub rigid: &'a Problem<'a>,
    /// The curves.
    pub tables: &'a [ErrorCurve],
    /// A file that nothing was fitted to.
    pub holdout: Option<&'a Measurements>,
    /// The nominal arm.
    pub robot: &'a Robot,
    /// The same with loads as they were stated, or without.
    pub unloaded: &'a Robot,
}

impl Show<'_> {
    /// Residuals of every row, predicted from the other folds with flags redone
    /// in each; the node's terms are held, their coefficients are not.
    ///
    /// # Errors
    /// When a fold's fit does not converge.
    pub fn held_out(&self, node: &Node, folds: &[Fold]) -> Result<HeldOut> {
        let problem = self.rigid.with_terms(node.fit.fit.state.terms.len());
        let flags = self.question.flags;
        let parts = Parts::new(&problem, &node.fit.fit, &node.fit, folds);
        let judged = folds.par_iter().enumerate().map(|(k, fold)| {
            let at = problem.linearise(&parts.robust(k, flags)?.fit.state);
            Ok(fold.held_out.iter().map(|r| (*r, at.residual(*r))).collect::<Vec<_>>())
        });
        let mut out = vec![None; problem.data.rows.len()];
        for fold in judged.collect::<Vec<Result<Vec<_>>>>() {
            for (row, residual) in fold? {
                out[row] = Some(residual);
            }
        }
        Ok(out)
    }

    /// The gap table. The rows left out of the hold-out figures are those that
    /// stand out from the final model by their own evidence.
    ///
    /// # Errors
    /// A hold-out file of unknown stations, or a fit that does not converge.
    pub fn gap(&self, nominal: &State, stages: &[Node]) -> Result<Vec<GapRow>> {
        let figures = Figures::of(self, &stages[stages.len() - 1])?;
        let train = |state: &State| figures.train(self, self.rigid, state);
        let held = |state: &State| figures.held(self, &[], state);
        let mut rows =
            vec![GapRow::new("nominal".to_owned(), train(nominal), None, held(nominal)?)];
        for (k, node) in stages.iter().enumerate() {
            let known =
                |c: &&Candidate| k > 0 && stages[k - 1].added.iter().any(|a| a.name() == c.name());
            let new = node.added.iter().find(|c| !known(c)).map(|c| c.name());
            let state = &node.fit.fit.state;
            let cross = figures.rms_of_rows(self, &self.held_out(node, self.question.folds)?);
            let name = new.map_or("geometry".to_owned(), stage_name);
            rows.push(GapRow::new(name, train(state), Some(cross), held(state)?));
        }
        Ok(rows)
    }

    /// Drops effects without which held-out poses are predicted as well, the least needed
    /// one first; the model that is left and its gap table. What helps only beside another
    /// effect is needed: a drift that geometry spreads over all links may predict poses
    /// worse by itself.
    ///
    /// # Errors
    /// As for [`Self::gap`].
    pub fn with_held_out_gain(
        &self,
        root: &Node,
        mut best: Node,
        nominal: &State,
    ) -> Result<Shown> {
        loop {
            let figures = Figures::of(self, &best)?;
            let left = |node: &Node| {
                let held_out = self.held_out(node, self.question.folds)?;
                Ok((figures.rms_of_rows(self, &held_out).sigmas, held_out))
            };
            let (own, held_out) = left(&best)?;
            let mut each = without_each(self.question, &best, &|node| Ok(left(node)?.0));
            match each.last_mut().filter(|least| least.left <= own).and_then(|l| l.node.take()) {
                Some(node) => best = node,
                None => {
                    let stages = stages(self.question, root, &best, &each)?;
                    let gap = self.gap(nominal, &stages)?;
                    return Ok(Shown { best, gap, held_out });
                }
            }
        }
    }

    /// The gap table of a model with error curves: curves first, then what stands
    /// beside them, each stage with curves of its own and held out in its folds
    /// curves and all. `best` is the last stage.
    ///
    /// # Errors
    /// As for [`Self::gap`].
    pub fn beside_curves(
        &self,
        root: &Node,
        best: Node,
        nominal: &State,
        stages: &[Stage],
    ) -> Result<Shown> {
        let figures = Figures::of(self, &best)?;
        let mut gap = self.gap(nominal, std::slice::from_ref(root))?;
        for (k, stage) in stages.iter().enumerate() {
            let problem = with_curves(self.rigid, &stage.tables);
            let own = |c: &&Candidate| stage.names.contains(&c.name());
            let added = best.added.iter().filter(own).cloned().collect();
            let q = Question { problem: &problem, ..*self.question };
            let node = fitted(&q, added, &best.fit.fit.state)?;
            let state = &node.fit.fit.state;
            // A spring alone bends other moments than those that were found beside all.
            let linear = stage.fitted.as_ref().filter(|_| k + 1 < stages.len());
            let train = linear.map(|rows| figures.rms_of_rows(self, rows));
            gap.push(GapRow::new(
                stage_name(stage.names.last().copied().unwrap_or(CURVE)),
                train.unwrap_or_else(|| figures.train(self, &problem, state)),
                Some(figures.rms_of_rows(self, &stage.held_out)),
                figures.held(self, &stage.tables, state)?,
            ));
        }
        let held_out = stages.last().map_or(HeldOut::new(), |stage| stage.held_out.clone());
        Ok(Shown { best, gap, held_out })
    }

    /// Names without which the hold-out file is missed by less, and by no little: of those with
    /// which the table's error rises, as what stands after an effect may be what it needs.
    ///
    /// # Errors
    /// A hold-out file of unknown stations.
    pub fn harmful(&self, best: &Node, gap: &[GapRow]) -> Result<Vec<&'static str>> {
        let row = |name: &str| gap.iter().find(|row| row.model == stage_name(name));
        let rises = |name: &str| row(name).is_some_and(|row| gain(gap, row) < -POLICY.rises);
        if self.holdout.is_none() || !best.added.iter().any(|c| rises(c.name())) {
            return Ok(Vec::new());
        }
        let figures = Figures::of(self, best)?;
        let missed = |node: &Node| {
            let held = figures.held(self, self.tables, &node.fit.fit.state)?;
            Ok(held.map_or(f64::INFINITY, |rms| rms.sigmas))
        };
        let most = missed(best)? / (1.0 + POLICY.rises);
        let each = without_each(self.question, best, &missed);
        let harmful = each.iter().filter(|without| rises(without.name) && without.left < most);
        Ok(harmful.map(|without| without.name).collect())
    }
}

/// Fall of the error of held-out poses from the stage before a row to the row.
pub(super) fn gain(gap: &[GapRow], row: &GapRow) -> f64 {
    let figure = |row: &GapRow| row.holdout_rms_sigmas.or(row.cross_validated_rms_sigmas);
    let k = gap.iter().position(|r| r.model == row.model).unwrap_or(0);
    match (k.checked_sub(1).and_then(|k| figure(&gap[k])), figure(row)) {
        (Some(before), Some(after)) if before > 0.0 => 1.0 - after / before,
        _ => 0.0,
    }
}

/// What the gap table calls the stage that adds an effect.
#[must_use]
pub fn stage_name(effect: &str) -> String {
    format!("+ {effect}")
}

/// Which rows count in a gap table.
struct Figures {
    /// Rows of the training that are flagged, and copies of those.
    flagged: Vec<usize>,
    /// Rows of the hold-out file that stand out from the final model.
    left_out: Vec<usize>,
}

impl Figures {
    fn of(show: &Show, last: &Node) -> Result<Self> {
        let own: Vec<usize> = last.fit.outliers.iter().map(|o| o.row).collect();
        // Copies of a row are what it is.
        let first = show.rigid.data.first_of_copies();
        let flagged = (0..first.len()).filter(|row| own.contains(&first[*row])).collect();
        let left_out = match show.holdout {
            Some(holdout) => {
                let state = &last.fit.fit.state;
                own_evidence(holdout, &show.on_holdout(holdout, show.tables, state)?).left_out
            }
            None => Vec::new(),
        };
        Ok(Self { flagged, left_out })
    }

    fn rms_of_rows(&self, show: &Show, rows: &[Option<Residual>]) -> Rms {
        rms(show.rigid.data, &show.rigid.noise, rows, &self.flagged)
    }

    fn train(&self, show: &Show, problem: &Problem, state: &State) -> Rms {
        let all = residuals(problem.data, &problem.conditions, state);
        self.rms_of_rows(show, &all.into_iter().map(Some).collect::<Vec<_>>())
    }

    fn held(&self, show: &Show, tables: &[ErrorCurve], state: &State) -> Result<Option<Rms>> {
        let Some(holdout) = show.holdout else { return Ok(None) };
        let all = show.on_holdout(holdout, tables, state)?;
        let all: Vec<_> = all.into_iter().map(Some).collect();
        Ok(Some(rms(holdout, &show.rigid.noise, &all, &self.left_out)))
    }
}

/// The final model and what shows it.
pub struct Shown {
    /// The model.
    pub best: Node,
    /// From nominal to it.
    pub gap: Vec<GapRow>,
    /// Its held-out residuals.
    pub held_out: HeldOut,
}

/// Of the rows that say something and are not left out.
pub(super) fn rms(
    data: &Measurements,
    noise: &Noise,
    left: &[Option<Residual>],
    without: &[usize],
) -> Rms {
    let used = |i: &usize| !without.contains(i) && left[*i].is_some_and(|r| !r.is_empty());
    let rows: Vec<usize> = (0..left.len()).filter(used).collect();
    let own: Vec<Residual> = rows.iter().filter_map(|i| left[*i]).collect();
    let each = rows.iter().zip(&own).map(|(i, r)| in_deviations(r, &data.rows[*i], noise));
    let (square, count) = each.fold((0.0, 0), |sum, r| (sum.0 + r.norm_squared(), sum.1 + r.len()));
    Rms {
        mm: Stats::of(&own).map_or(0.0, |s| s.rms_mm),
        sigmas: (square / (count as f64).max(1.0)).sqrt(),
    }
}

/// Held-out residuals of rows, where the others determine them.
pub type HeldOut = Vec<Option<Residual>>;
