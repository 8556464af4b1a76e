use truearm::JointKind;
use truearm::effects::ActsOn;

use crate::diagnose::candidates::Candidate;
use crate::diagnose::chi_square::chi_square;
use crate::diagnose::outcome::{Coefficient, Effect, GapRow};
use crate::diagnose::policy::POLICY;
use crate::diagnose::search::FAMILIES;
use crate::diagnose::search::node::{Node, at_floor};
use crate::effects::OUTLIERS;
use crate::identify::Findings;
use crate::identify::robust::Outlier;
use crate::model::{ModelTerm, Values, friction_unit};

/// The effects of the final model: one entry a name and order, couplings and
/// thermal links one each; flagged rows as `outliers`.
#[must_use]
pub fn effects(findings: &Findings, stages: &[Node], gap: &[GapRow], best: &Node) -> Vec<Effect> {
    let sigmas = findings.sigmas();
    let kinds: Vec<JointKind> = findings.problem.nominal.iter().map(|link| link.kind).collect();
    let first = findings.problem.unknowns.terms().start;
    let terms = &best.fit.fit.state.terms;
    let mut out: Vec<Effect> = Vec::new();
    for (k, pair) in stages.windows(2).enumerate() {
        let [before, stage] = pair else { continue };
        let (name, p_value) = step(before, stage);
        let figure = |row: &GapRow| row.holdout_rms_mm.or(row.cross_validated_rms_mm);
        let holdout_gain = match (figure(&gap[k + 1]), figure(&gap[k + 2])) {
            (Some(b), Some(a)) if b > 0.0 => 1.0 - a / b,
            _ => 0.0,
        };
        for (i, term) in terms.iter().enumerate().filter(|(_, t)| t.effect_name() == name) {
            let coefficients = vec![coefficient(term, &kinds, sigmas[first + i])];
            let (joints, order) = (term.joints(), term.order());
            add(
                &mut out,
                term,
                Effect { name, joints, order, coefficients, p_value, holdout_gain },
            );
        }
    }
    let gross = best.fit.outliers.iter().any(|o| !other_side(findings, best, o));
    // Where structure is left that has no name, no row can be called wrong.
    if gross && (at_floor(best) || !best.added.is_empty()) {
        let problem = findings.problem;
        let all: Vec<usize> = (0..problem.data.rows.len()).collect();
        let equations = problem.equations(&all) as f64;
        let p_value = (equations * libm::erfc(POLICY.gross / std::f64::consts::SQRT_2)).min(1.0);
        out.push(Effect {
            name: OUTLIERS,
            joints: Vec::new(),
            order: None,
            coefficients: Vec::new(),
            p_value,
            holdout_gain: 0.0,
        });
    }
    out
}

/// The effect that a stage adds to the one before, and its chance from noise.
fn step(before: &Node, stage: &Node) -> (&'static str, f64) {
    let known = |c: &&Candidate| before.added.iter().any(|a| a.name() == c.name());
    let added: Vec<&Candidate> = stage.added.iter().filter(|c| !known(c)).collect();
    let count = added.iter().map(|c| c.terms.len()).sum();
    let tried: f64 = added.iter().map(|c| c.tried * FAMILIES).product();
    let statistic = (before.misfit - stage.misfit) / stage.reduced.max(1.0);
    let p_value = (chi_square(statistic, count) * tried).min(1.0);
    (added.first().map_or("", |c| c.name()), p_value)
}

/// Adds a term's entry, or its joint and coefficient to the entry it belongs to.
fn add(out: &mut Vec<Effect>, term: &ModelTerm, new: Effect) {
    // Of one place: a coupled pair, or links that grow alike.
    let alone = matches!(term, ModelTerm::Arm(t)
        if t.effect.is_coupled() || t.effect.acts_on() == ActsOn::Lengths);
    let same = |e: &&mut Effect| {
        e.name == new.name && e.order == new.order && (!alone || e.joints == new.joints)
    };
    let Some(entry) = out.iter_mut().find(same) else { return out.push(new) };
    entry.coefficients.extend(new.coefficients);
    if !alone {
        entry.joints.extend(new.joints);
        entry.joints.sort_unstable();
        entry.joints.dedup();
    }
}

/// Whether a flagged row is where a link rests on the other side of its gap:
/// where friction and gravity are about equal, masses known to some per cent
/// and a base that leans a little do not tell the side. Such a row is left
/// out, but it is no gross error of the measurement.
fn other_side(findings: &Findings, best: &Node, outlier: &Outlier) -> bool {
    let problem = findings.problem;
    let state = &best.fit.fit.state;
    let equations = problem.linearise(state).equations(outlier.row);
    let residual = equations.scaled(&outlier.residual);
    state.terms.iter().zip(problem.unknowns.terms()).any(|(term, k)| {
        let ModelTerm::Arm(t) = term else { return false };
        let turn = -2.0 * t.coefficient / problem.unit(problem.unknowns.list()[k]);
        let left = |c: usize| residual[c] - equations.block[(c, k)] * turn;
        let left = Values::from_fn(residual.len(), left).norm();
        t.effect.needs_approach()
            && left < (POLICY.gap_share * residual.norm()).max(POLICY.gap_deviations)
    })
}

fn coefficient(term: &ModelTerm, kinds: &[JointKind], sigma: f64) -> Coefficient {
    let joint = match term {
        ModelTerm::Arm(t) => t.own_joint(),
        _ => None,
    };
    let force = joint.is_some_and(|joint| friction_unit(kinds, joint) == "N");
    Coefficient {
        joint: joint.map(|joint| usize::from(joint) + 1),
        part: term.part(),
        value: term.coefficient(),
        unit: term.unit(kinds),
        sigma,
        friction_nm: term.friction().filter(|_| !force),
        friction_n: term.friction().filter(|_| force),
    }
}
