//! The model that was found, and what shows how good it is.

use super::candidates::Candidate;
use super::described::Described;
use super::node::Node;
use super::outcome::{GapRow, Outcome, Verdict};
use super::policy::POLICY;
use super::show::{self, HeldOut, Show};
use super::weigh::{Nameless, Weighed, gross, without};
use super::{bending, described, noise_remarks, remarks, tell, verdict};
use crate::error::Result;
use crate::identify::fit::estimate::Estimate;
use crate::identify::fit::folds;
use crate::identify::start::zeros;
use crate::identify::{
    Findings, Identification, LambdaRule, Problem, RowResult, State, nominal_state,
};
use crate::model::{Instrument, Measurements, Model, ModelTerm, Robot};
use crate::observations::kind;

/// The result.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// With all terms, for evaluation and packing.
    pub model: Model,
    /// Figures and names.
    pub outcome: Outcome,
    /// Per row.
    pub rows: Vec<RowResult>,
    /// What was named, with base, marker and terms.
    pub state: State,
    /// The alternatives of the report, in its order.
    pub alternatives: Vec<State>,
    /// Springs fitted, but gave way against gravity as it was assumed.
    pub against_gravity: bool,
    /// The same of springs that would have been named.
    pub surely_against: bool,
}

impl Diagnosis {
    /// RMS by which poses held out are missed, in stated deviations of what was measured.
    #[must_use]
    pub fn misses(&self) -> f64 {
        let last = self.outcome.gap.last();
        let held = last.and_then(|last| last.cross_validated_rms_sigmas);
        held.map_or(f64::INFINITY, |held| held * self.outcome.noise_scale)
    }
}

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
    let assumed = show.unloaded.gravity.is_none() && show.robot.gravity.is_some();
    let show = &Show { robot: loaded(show, &best, &rivals), ..*show };
    let terms = problem.with_terms(best.fit.fit.state.terms.len());
    let findings = findings(show, &terms, &best, nominal, held_out)?;
    let bends = |c: &Candidate| bending::bends(c.name());
    let against_gravity = assumed && weighed.refused.iter().any(bends);
    let surely_against = assumed && weighed.surely_refused.iter().any(bends);
    let identified = identified(&findings, &weighed);
    let hold_out = show.hold_out(&best)?;
    let order = show.question.highest_order;
    let (effects, suspected) =
        show::effects(&findings, &gap, &best, &weighed, &harmful, (order, gross));
    let mut outcome = Outcome {
        figures: identified.figures,
        verdict: left.verdict,
        effects,
        suspected,
        unnamed: left.unnamed,
        described: left.described,
        noise_scale: weighed.scale * problem.noise.middle(problem.data),
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
    let instruments = &identified.model.instruments;
    let remarked = remarked(show, &outcome, (&weighed, &best, gross), instruments);
    outcome.figures.warnings.extend(remarked);
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

/// The arm with the masses of its models. Those that were assumed, or found, and move nothing
/// are in none.
fn loaded<'a>(show: &Show<'a>, best: &Node, rivals: &[State]) -> &'a Robot {
    match rivals.iter().chain([&best.fit.fit.state]).any(has_loads) {
        true => show.robot,
        false => show.unloaded,
    }
}

/// The model with its figures: errors by curves count, and the noise is that which was found.
fn identified(findings: &Findings, weighed: &Weighed) -> Identification {
    let mut out = findings.summarise();
    let point = &mut out.figures.uncertainty.tool_point;
    *point = point.with(weighed.by_curves.mean, weighed.by_curves.largest);
    let kinds = out.figures.kinds.iter_mut();
    kinds.for_each(|kind| kind.noise_scale *= weighed.scale);
    out
}

/// What is to be said beside an outcome.
fn remarked(
    show: &Show,
    of: &Outcome,
    (weighed, best, gross): (&Weighed, &Node, f64),
    instruments: &[Instrument],
) -> Vec<String> {
    let problem = show.question.problem;
    let effects = of.effects.iter().chain(&of.suspected);
    let mut out = Vec::new();
    out.extend(remarks::all(problem, best, weighed));
    out.extend(noise_remarks::tails(problem, best, gross));
    out.extend(remarks::aliased(problem.data, effects));
    out.extend(remarks::worse_elsewhere(problem.data, show.holdout, &of.gap));
    out.extend(remarks::far_off(show.holdout, &of.gap));
    out.extend(of.hold_out.iter().flat_map(remarks::standing_out));
    out.extend(zeros::found(instruments));
    out
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
