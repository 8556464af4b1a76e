use truearm::JointKind;
use truearm::effects::ActsOn;

use super::certainty::certainty;
use super::gap::{gain, stage_name};
use crate::diagnose::crowd::crowded;
use crate::diagnose::effect::{Coefficient, Effect};
use crate::diagnose::naming::{curve_probability, is_curve_named, is_few, is_named};
use crate::diagnose::node::Node;
use crate::diagnose::outcome::GapRow;
use crate::diagnose::policy::POLICY;
use crate::diagnose::weigh::{Curved, Doubt, Named, Weighed};
use crate::effects::OUTLIERS;
use crate::evidence::Aliases;
use crate::identify::fit::robust::Outlier;
use crate::identify::{Findings, Problem};
use crate::model::{CURVE, ModelTerm, Values, friction_unit};

/// What the final model holds beyond geometry: what may be named, and what is
/// only suspected. One entry a name and order, couplings and thermal links one
/// each; flagged rows as `outliers`.
#[must_use]
pub fn effects(
    findings: &Findings,
    gap: &[GapRow],
    best: &Node,
    weighed: &Weighed,
    harmful: &[&str],
    (highest_order, gross): (f64, f64),
) -> (Vec<Effect>, Vec<Effect>) {
    let certainty = certainty(findings, weighed.moments.as_ref());
    let kinds: Vec<JointKind> = findings.problem.nominal.iter().map(|link| link.kind).collect();
    let first = findings.problem.unknowns.terms().start;
    let terms = &best.fit.fit.state.terms;
    let sigmas = &certainty.sigmas[first..first + terms.len()];
    let (mut named, mut suspected) = curves(weighed, gap);
    for row in gap {
        let of = |t: &ModelTerm| row.model == stage_name(t.effect_name());
        for (i, term) in terms.iter().enumerate().filter(|(_, t)| of(t)) {
            let (name, joints) = (term.effect_name(), term.joints());
            let claim = weighed.names.iter().find(|n| n.name == name && n.joints == joints);
            let probability = probability(claim, terms, sigmas, i);
            let holdout_gain = gain(gap, row);
            let rises = harmful.contains(&name).then_some(Doubt::HeldOut);
            let sure = claim.is_some_and(is_named) && probability >= POLICY.named;
            let sure = sure && rises.is_none();
            let known = claim.is_some_and(|c| c.orders.is_empty())
                || of_order(claim, terms, sigmas, i) >= POLICY.named;
            let order_sigma = certainty.of_order(term);
            let effect = Effect {
                name,
                joints,
                order: term.order(),
                order_sigma,
                orders_alike: match order_sigma {
                    Some(sigma) if sigma > KNOWN => Vec::new(),
                    _ if known => alike(term, findings.problem, best, highest_order),
                    _ => others(claim, term),
                },
                time_constant_s: term.time_constant(),
                time_constant_sigma_s: term.time_constant().and(certainty.time_constant),
                coefficients: vec![coefficient(term, &kinds, sigmas[i])],
                probability,
                half_gain: claim.map_or([0.0; 2], |c| c.half_gain),
                doubt: claim.and_then(|c| c.doubt).or(rises),
                holdout_gain,
            };
            add(if sure { &mut named } else { &mut suspected }, term, effect);
        }
    }
    let any = best.fit.outliers.iter().any(|o| !other_side(findings, best, o));
    // Where more rows stand out than can be wrong, no row can be called so.
    if any && gross >= POLICY.suspected && !crowded(findings.problem, best) {
        let rows = gross_rows(findings, gross);
        if rows.probability >= POLICY.named { &mut named } else { &mut suspected }.push(rows);
    }
    (named, suspected)
}

/// How probable the effect of a term is. The claim is of the name at the joint: the most probable
/// of its orders has it.
fn probability(claim: Option<&Named>, terms: &[ModelTerm], sigmas: &[f64], term: usize) -> f64 {
    let own = |k: usize| of_order(claim, terms, sigmas, k);
    let of = |k: usize| (terms[k].effect_name(), terms[k].joints());
    let place = of(term);
    let other = |k: &usize| of(*k) == place && terms[*k].order() != terms[term].order();
    let more = |k: usize| own(k) > own(term) || (own(k) == own(term) && k < term);
    match (0..terms.len()).filter(other).any(more) {
        false => claim.map_or(0.0, |c| c.probability),
        true => own(term),
    }
}

/// How probable the order of a term is: by all models that hold it, or, of what all models of the
/// claim have, and of lines, by what it does.
fn of_order(claim: Option<&Named>, terms: &[ModelTerm], sigmas: &[f64], term: usize) -> f64 {
    let Some(claim) = claim else { return 0.0 };
    let told = claim.orders.iter().find(|order| Some(order.0) == terms[term].order());
    told.map_or_else(|| claim.probability * there(terms, sigmas, term), |order| order.1)
}

/// Other orders of the claim that it may as well be.
fn others(claim: Option<&Named>, term: &ModelTerm) -> Vec<f64> {
    let all = claim.map_or(&[][..], |claim| &claim.orders[..]);
    let may = |order: &&(f64, f64)| order.1 > 1.0 - POLICY.named && Some(order.0) != term.order();
    all.iter().filter(may).map(|order| order.0).collect()
}

/// How sure it is that the order of a term is there, where no model is without the claim's
/// strongest: another is as likely as not, and then of the strongest's size, before its cosine
/// and sine are looked at.
fn there(terms: &[ModelTerm], sigmas: &[f64], term: usize) -> f64 {
    let of = |t: &ModelTerm| (t.effect_name(), t.joints());
    let own = || terms.iter().zip(sigmas).filter(|(t, _)| of(t) == of(&terms[term]));
    let wave = |order: Option<f64>| Amplitude::of(own().filter(move |(t, _)| t.order() == order));
    let it = wave(terms[term].order());
    let strongest = own().map(|(t, _)| wave(t.order()));
    let strongest = strongest.max_by(|a, b| a.chi_square.total_cmp(&b.chi_square));
    match strongest {
        Some(strongest) if strongest.chi_square > it.chi_square => it.beside(strongest.variance),
        _ => 1.0,
    }
}

/// Cosine and sine of an order, or whatever coefficients a term has.
struct Amplitude {
    /// Mean square of the coefficients.
    variance: f64,
    /// Mean square of their standard deviations.
    noise: f64,
    chi_square: f64,
    count: f64,
}

impl Amplitude {
    fn of<'a>(parts: impl Iterator<Item = (&'a ModelTerm, &'a f64)>) -> Self {
        let mut out = Self { variance: 0.0, noise: 0.0, chi_square: 0.0, count: 0.0 };
        for (term, sigma) in parts {
            out.variance += term.coefficient().powi(2);
            out.noise += sigma.powi(2);
            out.chi_square += (term.coefficient() / sigma).powi(2);
            out.count += 1.0;
        }
        let mean = |sum: f64| sum / out.count;
        Self { variance: mean(out.variance), noise: mean(out.noise), ..out }
    }

    /// The probability that it is not nothing, where it would have coefficients of this variance:
    /// of normal numbers, by the marginal likelihoods.
    fn beside(&self, variance: f64) -> f64 {
        let size = variance / self.noise;
        let fits = self.chi_square / 2.0 * (size / (1.0 + size));
        1.0 / (1.0 + (self.count / 2.0 * size.ln_1p() - fits).exp())
    }
}

/// An order known to so many cycles a turn is one of those that look alike; of another any may be.
const KNOWN: f64 = 1.0;

/// Orders that look like a line's, as far as they are looked for, where its joint stood. A stated
/// ratio of gears tells its orders.
fn alike(term: &ModelTerm, problem: &Problem, best: &Node, highest_order: f64) -> Vec<f64> {
    let (Some(order), [joint]) = (term.order(), &term.joints()[..]) else { return Vec::new() };
    if term.effect_name() != truearm::effects::Effect::JointPeriodicError.name() {
        return Vec::new();
    }
    let rows = &problem.data.rows;
    let angles: Vec<f64> = best.fit.kept.iter().map(|row| rows[*row].q[joint - 1]).collect();
    Aliases::of(&angles, highest_order).others(order, &(1.0..=highest_order))
}

/// Error curves, one entry of all joints that surely have one, one of the others:
/// RMS over a turn and standard deviation of each.
fn curves(weighed: &Weighed, gap: &[GapRow]) -> (Vec<Effect>, Vec<Effect>) {
    let stage = stage_name(CURVE);
    let row = gap.iter().find(|row| row.model == stage);
    let entry = |which: bool| {
        let own = weighed.curves.iter().filter(|c| is_curve_named(c) == which);
        let own: Vec<&Curved> = own.collect();
        let least = |of: fn(&Curved) -> f64| own.iter().map(|c| of(c)).fold(1.0, f64::min);
        let doubt = match least(curve_probability) >= POLICY.named {
            true => Some(Doubt::Halves),
            false => own.iter().any(|c| is_few(c)).then_some(Doubt::Waves),
        };
        let effect = Effect {
            name: CURVE,
            joints: own.iter().map(|c| usize::from(c.table.joint()) + 1).collect(),
            order: None,
            order_sigma: None,
            orders_alike: Vec::new(),
            time_constant_s: None,
            time_constant_sigma_s: None,
            coefficients: own.iter().map(|c| curve_size(c)).collect(),
            probability: least(curve_probability),
            half_gain: [least(|c| c.half_gain[0]), least(|c| c.half_gain[1])],
            doubt: doubt.filter(|_| !which),
            holdout_gain: row.map_or(0.0, |row| gain(gap, row)),
        };
        (!own.is_empty()).then_some(effect).into_iter().collect()
    };
    (entry(true), entry(false))
}

fn curve_size(curve: &Curved) -> Coefficient {
    Coefficient {
        joint: Some(usize::from(curve.table.joint()) + 1),
        part: "RMS",
        value: curve.table.size()[1],
        unit: "rad",
        sigma: curve.table.band(),
        friction_nm: None,
        friction_n: None,
    }
}

/// Rows that stand out by more than chance does in so many equations, and are probably no tails.
fn gross_rows(findings: &Findings, gross: f64) -> Effect {
    let problem = findings.problem;
    let all: Vec<usize> = (0..problem.data.rows.len()).collect();
    let equations = problem.equations(&all) as f64;
    let chance = equations * libm::erfc(POLICY.gross / std::f64::consts::SQRT_2);
    Effect {
        name: OUTLIERS,
        joints: Vec::new(),
        order: None,
        order_sigma: None,
        orders_alike: Vec::new(),
        time_constant_s: None,
        time_constant_sigma_s: None,
        coefficients: Vec::new(),
        probability: gross.min(1.0 - chance.min(1.0)),
        half_gain: [0.0; 2],
        doubt: None,
        holdout_gain: 0.0,
    }
}

/// Adds a term's entry, or its joint and coefficient to the entry it belongs to.
fn add(out: &mut Vec<Effect>, term: &ModelTerm, new: Effect) {
    // Of one place: a coupled pair, or links that grow alike.
    let alone = matches!(term, ModelTerm::Arm(t)
        if t.effect.is_coupled() || t.effect.acts_on() == ActsOn::Lengths);
    let same = |e: &&mut Effect| {
        let order = e.order == new.order && e.orders_alike == new.orders_alike;
        e.name == new.name && order && (!alone || e.joints == new.joints)
    };
    let Some(entry) = out.iter_mut().find(same) else { return out.push(new) };
    entry.coefficients.extend(new.coefficients);
    // What is said of several joints holds for each.
    entry.probability = entry.probability.min(new.probability);
    entry.order_sigma = entry.order_sigma.zip(new.order_sigma).map(|(own, new)| own.max(new));
    if new.half_gain.iter().sum::<f64>() < entry.half_gain.iter().sum() {
        entry.half_gain = new.half_gain;
    }
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

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use truearm::effects::{Effect as Known, Term};
    use truearm_simulate::normal;

    use super::*;

    /// Cosines of waves in joints 1 and 2.
    fn terms() -> Vec<ModelTerm> {
        let of = |joint: u8, order: f64, coefficient: f64| {
            let effect = Known::JointPeriodicError;
            ModelTerm::Arm(Term { effect, joint, source: 0, component: 0, order, coefficient })
        };
        vec![of(0, 1.0, 1e-5), of(0, 2.0, 4e-4), of(0, 2.0, 0.0), of(1, 1.0, 1e-5)]
    }

    #[test]
    fn what_is_sure_of_a_name_is_not_of_each_of_its_orders() {
        let sure = |term: usize| there(&terms(), &[1e-5; 4], term);
        assert!(sure(0) < 0.1, "one deviation beside forty: {}", sure(0));
        assert_eq!((sure(1), sure(2)), (1.0, 1.0), "the strongest is the name's");
        assert_eq!(sure(3), 1.0, "another joint's only one");
        // Both large: both are there.
        let sure = there(&terms(), &[1e-6; 4], 0);
        assert!(sure > 0.999, "{sure}");
        // Nothing known of either, and nothing said.
        let sure = there(&terms(), &[1.0; 4], 0);
        assert!((sure - 0.5).abs() < 1e-3, "{sure}");
    }

    /// As often as is said: an order is there in half of the cases, of the strongest's size.
    #[test]
    fn orders_are_there_as_often_as_is_said() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (size, noise) = (3.0, 1.0);
        let variance = size * size;
        let (mut claims, mut true_ones, mut said) = (0.0, 0.0, 0.0);
        for k in 0..20_000 {
            let there = k % 2 == 0;
            let size = if there { size } else { 0.0 };
            let mut of = || size * normal(&mut rng) + noise * normal(&mut rng);
            let parts = [of(), of()];
            let squares = parts.iter().map(|x| x * x).sum::<f64>();
            let it = Amplitude {
                variance: squares / 2.0,
                noise: noise * noise,
                chi_square: squares / (noise * noise),
                count: 2.0,
            };
            let probability = it.beside(variance);
            if probability >= 0.9 {
                claims += 1.0;
                true_ones += f64::from(u8::from(there));
                said += probability;
            }
        }
        let (rate, said) = (true_ones / claims, said / claims);
        assert!((rate - said).abs() < 0.01, "{rate} of {claims}, said {said}");
        assert!(claims > 3000.0, "{claims}");
    }
}
