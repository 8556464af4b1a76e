use rayon::prelude::*;

use super::stages::stages;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::outcome::GapRow;
use crate::diagnose::question::Question;
use crate::error::{Error, Label, Result};
use crate::evaluate::residuals;
use crate::identify::estimate::without_parts;
use crate::identify::folds::Fold;
use crate::identify::robust::robust_fit_near;
use crate::identify::{Conditions, State};
use crate::model::{Measurements, Robot};
use crate::observations::Residual;
use crate::statistics::{Stats, own_evidence};

/// Held-out judgement of models.
#[derive(Clone, Copy)]
pub struct Show<'a> {
    /// What was asked.
    pub question: &'a Question<'a>,
    /// A file that nothing was fitted to.
    pub holdout: Option<&'a Measurements>,
    /// The nominal arm.
    pub robot: &'a Robot,
}

impl Show<'_> {
    /// Residuals of every row, predicted from the other folds with flags redone
    /// in each; the node's terms are held, their coefficients are not.
    ///
    /// # Errors
    /// When a fold's fit does not converge.
    pub fn held_out(&self, node: &Node, folds: &[Fold]) -> Result<HeldOut> {
        let problem = self.question.problem.with_terms(node.fit.fit.state.terms.len());
        let flags = self.question.flags;
        let starts = without_parts(&problem, &node.fit, folds, flags.lambda);
        let judged = folds.par_iter().zip(&starts).map(|(fold, start)| {
            let fit = robust_fit_near(&problem, &fold.fit, start, flags)?;
            let at = problem.linearise(&fit.fit.state);
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
        let data = self.question.problem.data;
        let last = &stages[stages.len() - 1];
        let flagged: Vec<usize> = last.fit.outliers.iter().map(|o| o.row).collect();
        let train = |state: &State| {
            let all = residuals(data, &self.question.problem.conditions, state);
            rms((0..all.len()).filter(|i| !flagged.contains(i)).map(|i| all[i]))
        };
        let left_out = match self.holdout {
            Some(holdout) => own_evidence(&self.on_holdout(holdout, &last.fit.fit.state)?),
            None => Vec::new(),
        };
        let held = |state: &State| -> Result<Option<f64>> {
            let Some(holdout) = self.holdout else { return Ok(None) };
            let all = self.on_holdout(holdout, state)?;
            Ok(Some(rms((0..all.len()).filter(|i| !left_out.contains(i)).map(|i| all[i]))))
        };
        let mut rows = vec![GapRow {
            model: "nominal".to_owned(),
            train_rms_mm: train(nominal),
            cross_validated_rms_mm: None,
            holdout_rms_mm: held(nominal)?,
        }];
        for (k, node) in stages.iter().enumerate() {
            let known =
                |c: &&Candidate| k > 0 && stages[k - 1].added.iter().any(|a| a.name() == c.name());
            let new = node.added.iter().find(|c| !known(c)).map(|c| c.name());
            let state = &node.fit.fit.state;
            let cross: Vec<_> = self.held_out(node, self.question.folds)?;
            let kept = (0..cross.len()).filter(|i| !flagged.contains(i)).filter_map(|i| cross[i]);
            rows.push(GapRow {
                model: new.map_or("geometry".to_owned(), stage_name),
                train_rms_mm: train(state),
                cross_validated_rms_mm: Some(rms(kept)),
                holdout_rms_mm: held(state)?,
            });
        }
        Ok(rows)
    }

    /// Drops effects that do not lower the error of held-out poses; the model that
    /// is left and its gap table.
    ///
    /// # Errors
    /// As for [`Self::gap`].
    pub fn with_held_out_gain(
        &self,
        root: &Node,
        mut best: Node,
        nominal: &State,
    ) -> Result<(Node, Vec<GapRow>)> {
        loop {
            let stages = stages(self.question, root, &best)?;
            let gap = self.gap(nominal, &stages)?;
            let held = |k: usize| gap[k + 1].cross_validated_rms_mm.unwrap_or(f64::INFINITY);
            let useless = (1..stages.len()).rev().find(|k| held(*k) >= held(k - 1));
            let Some(k) = useless else { return Ok((best, gap)) };
            let before = |c: &&Candidate| {
                let same = |a: &Candidate| a.name() == c.name();
                stages[k - 1].added.iter().any(same) || !stages[k].added.iter().any(same)
            };
            let added = best.added.iter().filter(before).cloned().collect();
            best = fitted(self.question, added, &best.fit.fit.state)?;
        }
    }

    /// Residuals of a hold-out file in the frames of the training.
    fn on_holdout(&self, holdout: &Measurements, state: &State) -> Result<Vec<Residual>> {
        let data = self.question.problem.data;
        let place = |known: &[String], label: &String, what: Label| {
            known.iter().position(|l| l == label).ok_or_else(|| unknown_label(holdout, what, label))
        };
        let mut bases = Vec::new();
        for label in &holdout.stations {
            bases.push(state.bases[place(&data.stations, label, Label::Station)?]);
        }
        let mut markers = Vec::new();
        for label in &holdout.markers {
            markers.push(state.markers[place(&data.markers, label, Label::Marker)?]);
        }
        let state = State { bases, markers, ..state.clone() };
        Ok(residuals(holdout, &Conditions::new(holdout, self.robot), &state))
    }
}

/// What the gap table calls the stage that adds an effect.
#[must_use]
pub fn stage_name(effect: &str) -> String {
    format!("+ {effect}")
}

fn rms(residuals: impl Iterator<Item = Residual>) -> f64 {
    Stats::of(&residuals.collect::<Vec<_>>()).map_or(0.0, |s| s.rms_mm)
}

/// Held-out residuals of rows, where the others determine them.
pub type HeldOut = Vec<Option<Residual>>;

/// A station or marker of a hold-out file that the training did not have.
fn unknown_label(data: &Measurements, of: Label, label: &str) -> Error {
    let what = of.name();
    Error::data(
        of.unknown(),
        format!("{}: {what} \"{label}\" is not in the training data", data.path.display()),
        "hold-out poses are judged in the frames of the training; for another station use \
         `truearm evaluate --reregister base`",
    )
}
