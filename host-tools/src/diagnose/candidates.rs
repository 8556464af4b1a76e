//! What may be missing: every effect of the repertoire that the data can test,
//! at every joint.

use truearm::effects::{Effect, Term};

use super::policy::POLICY;
use crate::identify::{Conditions, Problem};
use crate::model::ModelTerm;
use crate::model::Robot;

/// Friction levels tried for a joint.
const MOST_FRICTIONS: usize = 128;

/// One possible addition to a model: an effect at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its terms, coefficients zero.
    pub terms: Vec<ModelTerm>,
    /// How many alternatives of its kind were tried: the price of choosing.
    pub tried: f64,
}

impl Candidate {
    /// Name of the effect.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.terms.first().map_or("", ModelTerm::effect_name)
    }

    /// Joints as in reports.
    #[must_use]
    pub fn joints(&self) -> Vec<usize> {
        self.terms.first().map_or(Vec::new(), ModelTerm::joints)
    }

    /// Whether both cannot stand in one model: the same effect at the same
    /// place, but for periodic errors, of which a joint may have several.
    #[must_use]
    pub fn excludes(&self, other: &Self) -> bool {
        let orders = |c: &Self| c.terms.first().and_then(ModelTerm::order);
        let near = match (self.name(), orders(self), orders(other)) {
            ("joint-periodic-error", Some(a), Some(b)) => (a - b).abs() < POLICY.same_order,
            _ => true,
        };
        self.name() == other.name() && self.joints() == other.joints() && near
    }
}

fn arm(effect: Effect, joint: usize, order: f64, component: u8) -> ModelTerm {
    let joint = joint as u8;
    ModelTerm::Arm(Term { effect, joint, source: joint, component, order, coefficient: 0.0 })
}

/// Cosine and sine of each order.
pub fn periodic(effect: Effect, joint: usize, orders: &[f64]) -> Vec<ModelTerm> {
    let pair = |n: &f64| [arm(effect, joint, *n, 0), arm(effect, joint, *n, 1)];
    orders.iter().flat_map(pair).collect()
}

/// Friction torques at which gravity may take over the side of a gap, N m:
/// never, and levels between the torques of the rows, each of which sorts the
/// rows another way. A level next to the true one puts a row on the wrong side
/// of the gap, so few rows get every level.
fn frictions(conditions: &Conditions, joint: usize) -> Vec<f64> {
    let mut torques: Vec<f64> =
        conditions.rows.iter().filter_map(|r| r.torque.get(joint)).map(|t| t.abs()).collect();
    torques.sort_by(f64::total_cmp);
    let stride = torques.len().div_ceil(MOST_FRICTIONS).max(1);
    let mut out = vec![0.0];
    for pair in torques.windows(2).step_by(stride) {
        // A blob holds it in 1/64 N m.
        let level = ((pair[0] + pair[1]) / 2.0 * 64.0).round() / 64.0;
        if out.last().is_some_and(|last| level > *last) {
            out.push(level);
        }
    }
    out
}

/// All candidates but periodic ones of unknown order, and what cannot be
/// tested for want of a column.
#[must_use]
pub fn all(problem: &Problem, robot: &Robot) -> (Vec<Candidate>, Vec<String>) {
    let n = robot.joints.len();
    let c = &problem.conditions;
    let mut out: Vec<Candidate> = Vec::new();
    let mut missing = Vec::new();
    let mut add =
        |terms: Vec<ModelTerm>, tried: usize| out.push(Candidate { terms, tried: tried as f64 });
    if c.masses {
        for j in 0..n {
            add(vec![arm(Effect::JointCompliance, j, 0.0, 0)], n);
        }
        add((0..2).map(|k| arm(Effect::BaseCompliance, 0, 0.0, k)).collect(), 1);
    } else {
        missing
            .push("joint-compliance, base-compliance: need gravity_m_s2 and [[links]]".to_owned());
    }
    let mut geared = false;
    for (j, joint) in robot.joints.iter().enumerate() {
        add(periodic(Effect::EncoderEccentricity, j, &[1.0]), n);
        add(periodic(Effect::EncoderEccentricity, j, &[1.0, 2.0]), n);
        if let Some(ratio) = joint.gear_ratio {
            geared = true;
            // A strain-wave gear errs twice an input turn; others once.
            for orders in [&[2.0][..], &[2.0, 4.0], &[1.0], &[1.0, 2.0]] {
                let orders: Vec<f64> = orders.iter().map(|k| k * ratio).collect();
                add(periodic(Effect::GearTransmissionError, j, &orders), 4 * n);
            }
        }
        add(vec![arm(Effect::JointGain, j, 0.0, 0)], n);
        for source in (0..n).filter(|s| *s != j) {
            let mut term = arm(Effect::JointCoupling, j, 0.0, 0);
            if let ModelTerm::Arm(t) = &mut term {
                t.source = source as u8;
            }
            add(vec![term], n * (n - 1));
        }
        if c.direction {
            let levels = frictions(c, j);
            for friction in &levels {
                add(vec![arm(Effect::Backlash, j, *friction, 0)], n * levels.len());
            }
        }
    }
    if !geared {
        missing.push("gear-transmission-error: needs gear_ratio".to_owned());
    }
    if !c.direction {
        missing.push("backlash: needs columns dir1..".to_owned());
    }
    if c.temperature {
        let all = usize::from(Term::<f64>::ALL);
        add(vec![arm(Effect::ThermalExpansion, all, 0.0, 0)], 1);
        for (j, joint) in robot.joints.iter().enumerate() {
            let p = joint.link.parameters;
            if p.a != 0.0 || p.d != 0.0 {
                add(vec![arm(Effect::ThermalExpansion, j, 0.0, 0)], 4 * n);
            }
        }
    } else {
        missing.push("thermal-expansion: needs a column temperature_c that varies".to_owned());
    }
    if c.time {
        let drift = |component| ModelTerm::Drift { component, coefficient: 0.0 };
        add((0..6).map(drift).collect(), 1);
    } else {
        missing.push("measurement-drift: needs a column time_s".to_owned());
    }
    if c.series.len() > 1 {
        for series in &c.series[1..] {
            let shift =
                |axis| ModelTerm::Remount { series: series.clone(), axis, coefficient: 0.0 };
            add((0..3).map(shift).collect(), c.series.len() - 1);
        }
    } else {
        missing.push("tool-remount: needs a column series with several labels".to_owned());
    }
    (out, missing)
}

/// Terms that go into a blob.
#[must_use]
pub fn arm_terms(added: &[Candidate]) -> usize {
    added.iter().map(of_arm).sum()
}

pub(super) fn of_arm(candidate: &Candidate) -> usize {
    candidate.terms.iter().filter(|term| matches!(term, ModelTerm::Arm(_))).count()
}
