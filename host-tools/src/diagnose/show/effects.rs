use truearm::effects::{Effect as ArmEffect, Term};

use crate::diagnose::chi_square::chi_square;
use crate::diagnose::outcome::{Coefficient, Effect, GapRow};
use crate::diagnose::policy::POLICY;
use crate::diagnose::search::node::{Node, at_floor};
use crate::identify::Findings;
use crate::identify::robust::Outlier;
use crate::model::ModelTerm;

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
            tried *= candidate.tried * crate::diagnose::search::FAMILIES;
        }
        let statistic = (before.misfit - stage.misfit) / stage.reduced.max(1.0);
        let p_value = (chi_square(statistic, count) * tried).min(1.0);
        let figure = |row: &GapRow| row.holdout_rms_mm.or(row.cross_validated_rms_mm);
        let holdout_gain = match (figure(&gap[k]), figure(&gap[k + 1])) {
            (Some(b), Some(a)) if b > 0.0 => 1.0 - a / b,
            _ => 0.0,
        };
        let name = added.clone().next().map_or("", crate::diagnose::candidates::Candidate::name);
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
        let p_value = (3.0 * rows * libm::erfc(POLICY.gross / std::f64::consts::SQRT_2)).min(1.0);
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
            && left
                < (POLICY.gap_share * outlier.residual.norm())
                    .max(POLICY.gap_deviations * row.sigma)
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
