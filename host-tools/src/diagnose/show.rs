//! Showing what was found: the gap from nominal to the final model, on poses
//! that were not fitted; each effect with its coefficients; explanations that
//! stay within reach, and the poses that would tell them apart.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm::JointKind;
use truearm::effects::{Effect as ArmEffect, Term};

use super::node::{Node, at_floor};
use super::outcome::{Alternative, Coefficient, Effect, GapRow, SeparatingPose};
use super::search::Search;
use super::tail::chi_square;
use super::{HeldOut, unknown_label};
use crate::error::{Label, Result};
use crate::evaluate::residuals;
use crate::identify::folds::Fold;
use crate::identify::robust::{Outlier, robust_fit};
use crate::identify::{Conditions, Findings, State, folds};
use crate::model::ModelTerm;
use crate::model::{Measurements, Robot, Row};
use crate::report::{Stats, own_evidence};

/// Explanations this close, in units of chi-square, are not told apart: odds
/// of a hundred to one.
const WITHIN_REACH: f64 = 9.2;
/// Poses proposed to tell two explanations apart, out of so many tried.
const PROPOSED: usize = 5;
const TRIED: usize = 4000;

/// The models from geometry to the final one: each adds all terms of one
/// effect, the most telling first.
///
/// # Errors
/// When an intermediate fit does not converge.
pub fn stages(search: &Search, root: &Node, best: &Node) -> Result<Vec<Node>> {
    let mut names: Vec<&'static str> = Vec::new();
    for candidate in &best.added {
        if !names.contains(&candidate.name()) {
            names.push(candidate.name());
        }
    }
    let with = |chosen: &[&str], start: &Node| {
        let added = best.added.iter().filter(|c| chosen.contains(&c.name())).cloned().collect();
        search.fit(added, &start.fit.fit.state)
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

/// Held-out judgement of models.
#[derive(Clone, Copy)]
pub struct Show<'a> {
    /// The search they came from.
    pub search: &'a Search<'a>,
    /// Folds of poses.
    pub folds: &'a [Fold],
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
    pub fn held_out(&self, node: &Node) -> Result<HeldOut> {
        let start = &node.fit.fit.state;
        let problem = self.search.problem.with_terms(start.terms.len());
        let judged = self.folds.par_iter().map(|fold| {
            let fit = robust_fit(&problem, &fold.fit, start, self.search.flags)?;
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
        let data = self.search.problem.data;
        let last = &stages[stages.len() - 1];
        let flagged: Vec<usize> = last.fit.outliers.iter().map(|o| o.row).collect();
        let train = |state: &State| {
            let all = residuals(data, &self.search.problem.conditions, state);
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
            let known = |c: &&super::candidates::Candidate| {
                k > 0 && stages[k - 1].added.iter().any(|a| a.name() == c.name())
            };
            let new = node.added.iter().find(|c| !known(c)).map(|c| c.name());
            let state = &node.fit.fit.state;
            let cross: Vec<_> = self.held_out(node)?;
            let kept = (0..cross.len()).filter(|i| !flagged.contains(i)).filter_map(|i| cross[i]);
            rows.push(GapRow {
                model: new.map_or("geometry".to_owned(), |name| format!("+ {name}")),
                train_rms_mm: train(state),
                cross_validated_rms_mm: Some(rms(kept)),
                holdout_rms_mm: held(state)?,
            });
        }
        Ok(rows)
    }

    /// Residuals of a hold-out file in the frames of the training.
    fn on_holdout(&self, holdout: &Measurements, state: &State) -> Result<Vec<Vector3<f64>>> {
        let data = self.search.problem.data;
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

fn rms(residuals: impl Iterator<Item = Vector3<f64>>) -> f64 {
    Stats::of(&residuals.collect::<Vec<_>>()).map_or(0.0, |s| s.rms_mm)
}

/// The effects of the final model: one entry a name and order, couplings and
/// thermal links one each; flagged rows as `outliers`.
#[must_use]
pub fn effects(findings: &Findings, stages: &[Node], gap: &[GapRow], best: &Node) -> Vec<Effect> {
    let sigmas = findings.sigmas();
    let first = findings.problem.unknowns.terms().start;
    let terms = &best.fit.fit.state.terms;
    let mut out: Vec<Effect> = Vec::new();
    for (k, stage) in stages.iter().enumerate().skip(1) {
        let before = &stages[k - 1];
        let fresh = |name: &str| before.added.iter().all(|c| c.name() != name);
        let added = stage.added.iter().filter(|c| fresh(c.name()));
        let (mut count, mut tried) = (0, 1.0_f64);
        for candidate in added.clone() {
            count += candidate.terms.len();
            tried *= candidate.tried * super::search::FAMILIES;
        }
        let statistic = (before.misfit - stage.misfit) / stage.reduced.max(1.0);
        let p_value = (chi_square(statistic, count) * tried).min(1.0);
        let figure = |row: &GapRow| row.holdout_rms_mm.or(row.cross_validated_rms_mm);
        let holdout_gain = match (figure(&gap[k]), figure(&gap[k + 1])) {
            (Some(b), Some(a)) if b > 0.0 => 1.0 - a / b,
            _ => 0.0,
        };
        let name = added.clone().next().map_or("", super::candidates::Candidate::name);
        for (i, term) in terms.iter().enumerate().filter(|(_, t)| t.effect_name() == name) {
            let alone = matches!(term, ModelTerm::Arm(t)
                if matches!(t.effect, ArmEffect::JointCoupling | ArmEffect::ThermalExpansion));
            let joints = term.joints();
            let entry = out.iter_mut().find(|e| {
                e.name == name && e.order == term.order() && (!alone || e.joints == joints)
            });
            let coefficient = coefficient(term, sigmas[first + i]);
            match entry {
                Some(entry) => {
                    for joint in joints {
                        if !alone && !entry.joints.contains(&joint) {
                            entry.joints.push(joint);
                        }
                    }
                    entry.joints.sort_unstable_by(|a, b| if alone { a.cmp(a) } else { a.cmp(b) });
                    entry.coefficients.push(coefficient);
                }
                None => out.push(Effect {
                    name,
                    joints,
                    order: term.order(),
                    coefficients: vec![coefficient],
                    p_value,
                    holdout_gain,
                }),
            }
        }
    }
    let gross = best.fit.outliers.iter().any(|o| !other_side(findings, best, o));
    // Where structure is left that has no name, no row can be called wrong.
    if gross && (at_floor(best) || !best.added.is_empty()) {
        let rows = findings.problem.data.rows.len() as f64;
        let p_value = (3.0 * rows * libm::erfc(super::GROSS / std::f64::consts::SQRT_2)).min(1.0);
        out.push(Effect {
            name: "outliers",
            joints: Vec::new(),
            order: None,
            coefficients: Vec::new(),
            p_value,
            holdout_gain: 0.0,
        });
    }
    out
}

/// Whether a flagged row is where a link rests on the other side of its gap:
/// where friction and gravity are about equal, masses known to some per cent
/// and a base that leans a little do not tell the side. Such a row is left
/// out, but it is no gross error of the measurement.
fn other_side(findings: &Findings, best: &Node, outlier: &Outlier) -> bool {
    let problem = findings.problem;
    let state = &best.fit.fit.state;
    let row = &problem.data.rows[outlier.row];
    let equations = problem.linearise(state).equations(outlier.row);
    state.terms.iter().zip(problem.unknowns.terms()).any(|(term, k)| {
        let ModelTerm::Arm(t) = term else { return false };
        let per_unit = equations.block.column(k) * problem.metres(outlier.row);
        let shift = per_unit * (-2.0 * t.coefficient / problem.unit(problem.unknowns.list()[k]));
        let left = (outlier.residual - shift).norm();
        t.effect == ArmEffect::Backlash
            && left < (0.3 * outlier.residual.norm()).max(4.0 * row.sigma)
    })
}

fn coefficient(term: &ModelTerm, sigma: f64) -> Coefficient {
    let (part, friction) = match term {
        ModelTerm::Arm(t) => match t.effect {
            ArmEffect::BaseCompliance => (["x", "y"][usize::from(t.component) % 2], None),
            ArmEffect::EncoderEccentricity
            | ArmEffect::GearTransmissionError
            | ArmEffect::JointPeriodicError => (["cos", "sin"][usize::from(t.component) % 2], None),
            ArmEffect::Backlash => ("", Some(t.order).filter(|f| *f > 0.0)),
            _ => ("", None),
        },
        ModelTerm::Drift { component, .. } => (["rx", "ry", "rz", "x", "y", "z"][*component], None),
        ModelTerm::Remount { axis, .. } => (["x", "y", "z"][*axis], None),
    };
    Coefficient {
        joint: match term {
            ModelTerm::Arm(t) if t.effect == ArmEffect::BaseCompliance => None,
            ModelTerm::Arm(t) if t.joint == Term::<f64>::ALL => None,
            ModelTerm::Arm(t) => Some(usize::from(t.joint) + 1),
            _ => None,
        },
        part,
        value: term.coefficient(),
        unit: term.unit(),
        sigma,
        friction_nm: friction,
    }
}

/// Explanations of the data that stay within reach of the best one.
#[must_use]
pub fn alternatives(
    search: &Search,
    robot: &Robot,
    best: &Node,
    nodes: &[Node],
) -> Vec<(Alternative, State)> {
    let names = |n: &Node| {
        let mut list: Vec<_> = n.added.iter().map(|c| (c.name(), c.joints())).collect();
        list.sort();
        list.dedup();
        list
    };
    let mine = names(best);
    let mut seen = vec![mine.clone()];
    let mut out = Vec::new();
    for node in nodes {
        let theirs = names(node);
        // More of the same is no alternative.
        let contains = mine.iter().all(|m| theirs.contains(m));
        if contains || seen.contains(&theirs) || !at_floor(node) {
            continue;
        }
        // Judged by the data alone: what a coefficient more costs is a reason to
        // prefer, not to rule out. A row that had to be flagged for it counts
        // what it would have cost at least, or a few new poses that speak
        // against an explanation would be taken for gross errors.
        let data = |n: &Node| n.misfit + n.fit.outliers.len() as f64 * super::GROSS.powi(2);
        let worse_by = data(node) - data(best);
        if worse_by > WITHIN_REACH || node.added.len() > best.added.len() {
            continue;
        }
        seen.push(theirs.clone());
        let poses = separating(search, robot, &best.fit.fit.state, &node.fit.fit.state);
        let alternative = Alternative { effects: theirs, worse_by, separating_poses: poses };
        out.push((alternative, node.fit.fit.state.clone()));
    }
    out
}

/// Rows that could be measured next, under the conditions of the first row of
/// `data`, approached from either side; no point is known of them.
#[must_use]
pub fn trial_rows(data: &Measurements, poses: &[Vec<f64>], rng: &mut ChaCha8Rng) -> Measurements {
    let like = &data.rows[0];
    let rows = poses.iter().map(|q| {
        let directions =
            like.directions.iter().map(|_| if rng.random_bool(0.5) { 1 } else { -1 }).collect();
        Row { q: q.clone(), directions, point: Vector3::zeros(), ..like.clone() }
    });
    Measurements { rows: rows.collect(), ..data.clone() }
}

/// Poses within limits where two explanations differ most.
fn separating(search: &Search, robot: &Robot, a: &State, b: &State) -> Vec<SeparatingPose> {
    let data = search.problem.data;
    let mut rng = ChaCha8Rng::seed_from_u64(folds::SEED);
    let ranges: Vec<[f64; 2]> =
        robot.joints.iter().zip(data.covered()).map(|(j, c)| j.limits.unwrap_or(c)).collect();
    let pose = |_| ranges.iter().map(|[low, high]| rng.random_range(*low..=*high)).collect();
    let poses: Vec<Vec<f64>> = (0..TRIED).map(pose).collect();
    let tried = trial_rows(data, &poses, &mut rng);
    let conditions = Conditions::new(&tried, robot);
    let (first, second) = (residuals(&tried, &conditions, a), residuals(&tried, &conditions, b));
    let mut order: Vec<(f64, usize)> =
        first.iter().zip(&second).map(|(a, b)| (a - b).norm()).zip(0..TRIED).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut out: Vec<(usize, f64)> = Vec::new();
    for (difference, i) in order {
        // Not five times the same pose.
        let apart = |(j, _): &(usize, f64)| {
            let d = tried.rows[*j].q.iter().zip(&tried.rows[i].q).map(|(a, b)| (a - b).powi(2));
            d.sum::<f64>().sqrt() > 0.6
        };
        if out.len() < PROPOSED && out.iter().all(apart) {
            out.push((i, difference));
        }
    }
    let show = |(i, difference): (usize, f64)| SeparatingPose {
        joints: tried.rows[i]
            .q
            .iter()
            .zip(&robot.joints)
            .map(|(q, j)| match j.link.kind {
                JointKind::Revolute => (q.to_degrees() * 100.0).round() / 100.0,
                JointKind::Prismatic => (q * 1e5).round() / 100.0,
            })
            .collect(),
        difference_mm: difference * 1e3,
    };
    out.into_iter().map(show).collect()
}
