use rayon::prelude::*;

use super::stages::stages;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::outcome::GapRow;
use crate::diagnose::question::Question;
use crate::diagnose::weigh::{Stage, with_curves};
use crate::error::{Error, Label, Result};
use crate::evaluate::{known_instruments, residuals};
use crate::identify::cross_validation::Parts;
use crate::identify::folds::Fold;
use crate::identify::{Conditions, Problem, State};
use crate::model::{CURVE, ErrorCurve, Measurements, Robot};
use crate::observations::Residual;
use crate::statistics::{Stats, own_evidence};

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
            let cross = figures.rms_of_rows(&self.held_out(node, self.question.folds)?);
            rows.push(GapRow {
                model: new.map_or("geometry".to_owned(), stage_name),
                train_rms_mm: train(state),
                cross_validated_rms_mm: Some(cross),
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
    ) -> Result<Shown> {
        loop {
            let stages = stages(self.question, root, &best)?;
            let gap = self.gap(nominal, &stages)?;
            let held = |k: usize| gap[k + 1].cross_validated_rms_mm.unwrap_or(f64::INFINITY);
            let useless = (1..stages.len()).rev().find(|k| held(*k) >= held(k - 1));
            let Some(k) = useless else {
                let held_out = self.held_out(&best, self.question.folds)?;
                return Ok(Shown { best, gap, held_out });
            };
            let before = |c: &&Candidate| {
                let same = |a: &Candidate| a.name() == c.name();
                stages[k - 1].added.iter().any(same) || !stages[k].added.iter().any(same)
            };
            let added = best.added.iter().filter(before).cloned().collect();
            best = fitted(self.question, added, &best.fit.fit.state)?;
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
        for stage in stages {
            let problem = with_curves(self.rigid, &stage.tables);
            let own = |c: &&Candidate| stage.names.contains(&c.name());
            let added = best.added.iter().filter(own).cloned().collect();
            let q = Question { problem: &problem, ..*self.question };
            let node = fitted(&q, added, &best.fit.fit.state)?;
            gap.push(GapRow {
                model: stage_name(stage.names.last().copied().unwrap_or(CURVE)),
                train_rms_mm: figures.train(self, &problem, &node.fit.fit.state),
                cross_validated_rms_mm: Some(figures.rms_of_rows(&stage.held_out)),
                holdout_rms_mm: figures.held(self, &stage.tables, &node.fit.fit.state)?,
            });
        }
        let held_out = stages.last().map_or(HeldOut::new(), |stage| stage.held_out.clone());
        Ok(Shown { best, gap, held_out })
    }

    /// Residuals of a hold-out file in the frames of the training.
    fn on_holdout(
        &self,
        holdout: &Measurements,
        tables: &[ErrorCurve],
        state: &State,
    ) -> Result<Vec<Residual>> {
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
        let instruments = known_instruments(&state.instruments, holdout)?;
        let state = State { bases, markers, instruments, ..state.clone() };
        let conditions = Conditions::new(holdout, self.robot).with_curves(holdout, tables);
        Ok(residuals(holdout, &conditions, &state))
    }
}

/// What the gap table calls the stage that adds an effect.
#[must_use]
pub fn stage_name(effect: &str) -> String {
    format!("+ {effect}")
}

/// Which rows count in a gap table.
struct Figures {
    /// Rows of the training that are flagged.
    flagged: Vec<usize>,
    /// Rows of the hold-out file that stand out from the final model.
    left_out: Vec<usize>,
}

impl Figures {
    fn of(show: &Show, last: &Node) -> Result<Self> {
        let flagged = last.fit.outliers.iter().map(|o| o.row).collect();
        let left_out = match show.holdout {
            Some(holdout) => {
                own_evidence(&show.on_holdout(holdout, show.tables, &last.fit.fit.state)?)
            }
            None => Vec::new(),
        };
        Ok(Self { flagged, left_out })
    }

    fn rms_of_rows(&self, rows: &[Option<Residual>]) -> f64 {
        rms((0..rows.len()).filter(|i| !self.flagged.contains(i)).filter_map(|i| rows[i]))
    }

    fn train(&self, show: &Show, problem: &Problem, state: &State) -> f64 {
        let all = residuals(show.question.problem.data, &problem.conditions, state);
        rms((0..all.len()).filter(|i| !self.flagged.contains(i)).map(|i| all[i]))
    }

    fn held(&self, show: &Show, tables: &[ErrorCurve], state: &State) -> Result<Option<f64>> {
        let Some(holdout) = show.holdout else { return Ok(None) };
        let all = show.on_holdout(holdout, tables, state)?;
        Ok(Some(rms((0..all.len()).filter(|i| !self.left_out.contains(i)).map(|i| all[i]))))
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
