//! The model that was found, and what shows how good it is.

use super::candidates::Candidate;
use super::described::Described;
use super::node::Node;
use super::outcome::{GapRow, Outcome, Verdict};
use super::policy::POLICY;
use super::show::{self, HeldOut, Show};
use super::weigh::{Nameless, Weighed, gross, without};
use super::{Diagnosis, described, moments, noise_remarks, remarks, tell, verdict};
use crate::error::Result;
use crate::identify::fit::estimate::Estimate;
use crate::identify::fit::folds;
use crate::identify::start::zeros;
use crate::identify::{Findings, LambdaRule, Problem, State, nominal_state};
use crate::model::{Measurements, ModelTerm};
use crate::observations::kind;

/// What was found.
pub struct Found {
    /// What the evidence says.
    pub weighed: Weighed,
    /// The final model.
    pub best: Node,
    /// Geometry alone.
    pub root: Node,
    /// Where the first fit began.
    pub start: State,
    /// What needs columns or keys that the data do not have.
    pub not_testable: Vec<String>,
}

/// The model, and what shows how good it is.
///
/// # Errors
/// A fit that does not converge.
pub fn shown(show: &Show, found: Found) -> Result<Diagnosis> {
    let Found { weighed, best, root, start, not_testable } = found;
    let problem = show.question.problem;
    let holdout = show.holdout.map(|held| held.with_noise(weighed.scale));
    let show = &Show { holdout: holdout.as_ref(), ..*show };
    let nominal = nominal_state(show.rigid, &best.fit.kept, &start)?;
    let shown = match weighed.stages.is_empty() {
        true => show.with_held_out_gain(&root, best, &nominal)?,
        false => show.beside_curves(&root, best, &nominal, &weighed.stages)?,
    };
    let (best, gap, held_out) = (shown.best, shown.gap, shown.held_out);
    let harmful = show.harmful(&best, &gap)?;
    let left = Left::of(show, &weighed, (&root, &best), &gap);
    let Left { gross, .. } = left;
    let alternatives = show::alternatives(show.question, show.robot, &best, &weighed.rivals);
    let (alternatives, rivals): (_, Vec<State>) = alternatives.into_iter().unzip();
    // Masses that were assumed, or found, and move nothing are in no model.
    let bent = rivals.iter().chain([&best.fit.fit.state]).any(has_loads);
    let assumed = show.unloaded.gravity.is_none() && show.robot.gravity.is_some();
    let robot = if bent { show.robot } else { show.unloaded };
    let show = &Show { robot, ..*show };
    let terms = problem.with_terms(best.fit.fit.state.terms.len());
    let findings = findings(show, &terms, &best, nominal, held_out)?;
    let bends = |c: &Candidate| moments::bends(c.name());
    let against_gravity = assumed && weighed.refused.iter().any(bends);
    let surely_against = assumed && weighed.surely_refused.iter().any(bends);
    let mut identified = findings.summarise();
    let hold_out = show.hold_out(&best)?;
    let point = &mut identified.figures.uncertainty.tool_point;
    *point = point.with(weighed.by_curves.mean, weighed.by_curves.largest);
    let order = show.question.highest_order;
    let (effects, suspected) =
        show::effects(&findings, &gap, &best, &weighed, &harmful, (order, gross));
    let warnings = &mut identified.figures.warnings;
    warnings.extend(remarks::all(problem, &best, &weighed));
    warnings.extend(noise_remarks::tails(problem, &best, gross));
    warnings.extend(remarks::aliased(problem.data, effects.iter().chain(&suspected)));
    warnings.extend(remarks::worse_elsewhere(problem.data, show.holdout, &gap));
    warnings.extend(remarks::far_off(show.holdout, &gap));
    warnings.extend(hold_out.iter().flat_map(remarks::standing_out));
    warnings.extend(zeros::found(&identified.model.instruments));
    let kinds = &mut identified.figures.kinds;
    kinds.iter_mut().for_each(|kind| kind.noise_scale *= weighed.scale);
    let noise_scale = weighed.scale * problem.noise.middle(problem.data);
    let outcome = Outcome {
        figures: identified.figures,
        verdict: left.verdict,
        effects,
        suspected,
        unnamed: left.unnamed,
        described: left.described,
        noise_scale,
        beyond_repeats: remarks::over_repeats(problem, &best),
        nested_rms_mm: weighed.nested_rms_mm(&best.fit.kept),
        noise_floor_mm: noise_floor(problem.data) * 1e3 / weighed.scale,
        reduced_chi_square: best.reduced,
        geometry_reduced_chi_square: root.reduced,
        gap,
        hold_out,
        alternatives,
        not_testable,
        whereabouts: left.whereabouts,
    };
    Ok(Diagnosis {
        model: identified.model,
        outcome,
        rows: identified.rows,
        state: best.fit.fit.state,
        alternatives: rivals,
        against_gravity,
        surely_against,
    })
}

/// What the model leaves, in words, and what that makes of it.
struct Left {
    /// Where what is left is.
    whereabouts: Vec<String>,
    /// What has no name, described.
    described: Vec<Described>,
    /// How probable it is that flagged rows are gross errors.
    gross: f64,
    /// What that makes of the model...
    verdict: Verdict,
    /// ...and why.
    unnamed: Vec<String>,
}

impl Left {
    fn of(show: &Show, weighed: &Weighed, (root, best): (&Node, &Node), gap: &[GapRow]) -> Self {
        let problem = show.question.problem;
        let with_terms = problem.with_terms(best.fit.fit.state.terms.len());
        // But for a slip, which is what is asked.
        let mut nameless = weighed.held_nameless();
        nameless.retain(|(what, _)| !matches!(what, Nameless::Slip { .. }));
        let apart = without(&with_terms, &best.fit.fit.state, &nameless);
        let beside = !(best.added.is_empty() && nameless.is_empty());
        let found = beside.then_some((&apart, best));
        let lambda = show.question.flags.lambda;
        let (whereabouts, least) = tell::sentences(show.rigid, root, found, lambda);
        let goes_with = least.filter(|(p, _)| *p < POLICY.beyond_chance).map(|(_, words)| words);
        let described = described::described(problem, weighed);
        let sources: Vec<_> = weighed.scattering.iter().map(|source| source.0).collect();
        let gross = gross(&apart, best, &sources);
        let judged = (weighed, &described[..]);
        let (verdict, unnamed) = verdict::verdict(problem, judged, (best, gross), gap, goes_with);
        Self { whereabouts, described, gross, verdict, unnamed }
    }
}

/// 3-D RMS that the stated standard deviations leave, m.
fn noise_floor(data: &Measurements) -> f64 {
    let rows = &data.rows;
    let variance: f64 = rows.iter().map(|r| kind(r).noise(r).powi(2)).sum();
    (variance / rows.len() as f64).sqrt()
}

/// The final model as an estimate, with its held-out errors.
fn findings<'a>(
    show: &Show<'a>,
    problem: &'a Problem<'a>,
    best: &Node,
    nominal: State,
    held_out: HeldOut,
) -> Result<Findings<'a>> {
    let q = show.question;
    let blocked = match folds::blocked(problem.data, q.rows) {
        Some(folds) if show.tables.is_empty() => Some(show.held_out(best, &folds)?),
        _ => None,
    };
    Ok(Findings {
        rule: LambdaRule::MaximumLikelihood,
        robot: show.robot,
        problem,
        rigid: show.rigid,
        nominal,
        found: Estimate {
            fit: best.fit.fit.clone(),
            robust: best.fit.clone(),
            lambda: q.flags.lambda,
            choice: None,
            solved: None,
        },
        curves: show.tables.to_vec(),
        held_out,
        blocked,
        cross_validation: format!(
            "{} folds of poses, flags redone in each, terms held",
            q.folds.len()
        ),
    })
}

/// Whether any term depends on gravity.
fn has_loads(state: &State) -> bool {
    let loaded = |t: &ModelTerm| matches!(t, ModelTerm::Arm(term) if term.needs_load());
    state.terms.iter().any(loaded)
}
