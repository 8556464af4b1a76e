//! What a reader of the model should know of how it came about.

use std::collections::BTreeMap;

use truearm::effects::{Effect, MAX_TERMS};

use super::bending::bends;
use super::candidates::{self, Candidate};
use super::effect::Effect as Shown;
use super::moments::Moments;
use super::node::Node;
use super::noise_remarks as noise;
use super::outcome::{GapRow, HoldOut, Worse, worse};
use super::policy::POLICY;
use super::rounding;
use super::tell::place;
use super::weigh::{Doubt, Named, Weighed, scatter};
use crate::error::listed;
use crate::identify::Problem;
use crate::model::{Clock, Measurements, ModelTerm};
use crate::observations::kind;
use crate::statistics::repeats::Scatter;
use crate::units::to_mm;

/// All of them.
pub fn all<'a>(
    problem: &'a Problem,
    best: &Node,
    weighed: &'a Weighed,
) -> impl Iterator<Item = String> + 'a {
    let data = problem.data;
    [
        too_many(best),
        guessed(data, best),
        numbered(data, best),
        loads(data, best),
        beyond_repeats(problem, best),
        few_angles(data, best, &weighed.names),
        weightless(best, weighed),
        balanced(problem, best),
        rounding::remark(problem, best).filter(|_| noise::joints(weighed).next().is_none()),
    ]
    .into_iter()
    .flatten()
    .chain(wrong_holes(data, best))
    .chain(noise::all(problem, weighed))
}

/// A joint that gives way under its load and errs once a turn: whoever balances it with a spring
/// whose force nobody stated sees the same. In 28 of 40 sessions of such arms that somebody else
/// made it was a sure eccentricity of the encoder, of 0.14 to 2.7 mrad.
fn balanced(problem: &Problem, best: &Node) -> Option<String> {
    let has = |effect: Effect, joint: &[usize]| {
        best.added.iter().any(|c| c.name() == effect.name() && c.joints() == joint)
    };
    let once = |c: &&Candidate| c.terms.iter().any(|term| term.order() == Some(1.0));
    let eccentric = best.added.iter().filter(|c| c.name() == Effect::EncoderEccentricity.name());
    let loaded = eccentric.filter(once).map(Candidate::joints).find(|joints| {
        let [joint] = joints[..] else { return false };
        problem.conditions.is_loaded(joint - 1) && has(Effect::JointCompliance, joints)
    })?;
    Some(format!(
        "{}: {}: where the joint is balanced by a spring (a counterbalance, a gas spring), the \
         force of that, which nobody stated, does the same as it gives way; find out which of \
         both it is before its encoder is looked at: the correction is the same",
        problem.data.path.display(),
        place(Effect::EncoderEccentricity.name(), &loaded)
    ))
}

/// Lines whose order is not told: those of other orders look the same where a joint stood.
pub fn aliased<'a>(data: &Measurements, effects: impl Iterator<Item = &'a Shown>) -> Vec<String> {
    let file = data.path.display();
    let remark = |effect: &Shown| {
        let [order, others] = effect.said_alike()?;
        let place = place(effect.name, &effect.joints);
        Some(format!(
            "{file}: {place}: at its angles {order} cycles a turn look like {others}: elsewhere \
             the correction may be of the wrong order; measure more of its turn, at angles of \
             other distances"
        ))
    };
    effects.filter_map(remark).collect()
}

/// Remarks where poses that no fit saw are missed by more than with less of a model.
pub fn worse_elsewhere(
    data: &Measurements,
    holdout: Option<&Measurements>,
    gap: &[GapRow],
) -> Vec<String> {
    let remark = |(of, poses, worse): (&Measurements, &str, Option<Worse>)| {
        let Worse { rms_mm, less_mm, drawn } = worse?;
        let less = if drawn { "the drawn arm" } else { "geometry alone" };
        Some(format!(
            "{}: {poses} are missed by {rms_mm:.3} mm RMS, with {less} by {less_mm:.3}: the model \
             makes them worse; look for wrong rows (`truearm check`) and measure more poses like \
             those before it is flashed",
            of.path.display()
        ))
    };
    let [crossed, held] = worse(gap);
    let crossed = (data, "poses of a fold that was left out", crossed);
    let held = holdout.map(|holdout| (holdout, "its poses", held));
    [crossed].into_iter().chain(held).filter_map(remark).collect()
}

/// Poses of the hold-out file that are missed by so many times what poses of the training are
/// that were held out: no study set it.
const ELSEWHERE: f64 = 5.0;

/// A remark where the hold-out file is missed by far more than poses held out in folds are, as
/// all its rows may be: none of them stands out then.
pub fn far_off(holdout: Option<&Measurements>, gap: &[GapRow]) -> Option<String> {
    let (file, last) = (&holdout?.path, gap.last()?);
    let times = last.holdout_rms_sigmas? / last.cross_validated_rms_sigmas?;
    (times > ELSEWHERE).then(|| {
        format!(
            "{}: its poses are missed by {times:.0} times what poses held out in folds are: they are of \
             another arm, tool or place of what measures, their rows are wrong, or they lie where \
             little was fitted",
            file.display()
        )
    })
}

/// Remarks on rows of the hold-out file that stand out: those that its figures leave out, and
/// those that they have.
pub fn standing_out(of: &HoldOut) -> Vec<String> {
    let (file, all) = (&of.file, of.all_rows_rms_mm);
    let left_out = (!of.left_out.is_empty()).then(|| {
        format!(
            "{file}: left out of the hold-out figures, as they stand out by more than 10 robust \
             standard deviations: rows {}; {all:.3} mm RMS with all",
            listed(&of.left_out)
        )
    });
    let counted = (!of.standing_out.is_empty()).then(|| {
        format!(
            "{file}: {} of {} rows stand out by more than 10 robust standard deviations and count in \
             the hold-out figures: rows {}; look for wrong rows among them, or for what the model misses \
             there",
            of.standing_out.len(),
            of.rows,
            listed(&of.standing_out)
        )
    });
    [left_out, counted].into_iter().flatten().collect()
}

/// A remark where the model has a function of a joint's angle that few angles show: what
/// held-out poses say is of these angles as well.
fn few_angles(data: &Measurements, best: &Node, names: &[Named]) -> Option<String> {
    let at_few = |name: &&Named| {
        let own = |c: &Candidate| c.name() == name.name && c.joints() == name.joints;
        name.doubt == Some(Doubt::Levels) && best.added.iter().any(own)
    };
    let effects: Vec<String> =
        names.iter().filter(at_few).map(|n| place(n.name, &n.joints)).collect();
    (!effects.is_empty()).then(|| {
        format!(
            "{}: {}: measured at so few angles that other functions do the same there; between \
             them the correction may be worse than none: measure a few poses in between",
            data.path.display(),
            effects.join(", ")
        )
    })
}

/// How many times farther off poses are than their repeats scatter, where that is many.
pub fn over_repeats(problem: &Problem, best: &Node) -> Option<f64> {
    let Scatter { within, between } = scatter(problem, best)?;
    let times = (between / within).max(0.0).sqrt();
    (times > POLICY.beyond_repeats && times.is_finite()).then_some(times)
}

/// A remark where poses are farther off than their repeats scatter.
fn beyond_repeats(problem: &Problem, best: &Node) -> Option<String> {
    over_repeats(problem, best).map(|times| {
        format!(
            "{}: the model leaves poses off by {times:.1} times what their repeats scatter: most \
             of what is left returns with the pose, is of the arm or of what measured it there, \
             and has no name",
            problem.data.path.display()
        )
    })
}

/// A remark where springs give way against the torques of the file.
fn loads(data: &Measurements, best: &Node) -> Option<String> {
    let spring =
        |t: &ModelTerm| matches!(t, ModelTerm::Arm(t) if t.effect == Effect::JointCompliance);
    let mut springs = best.fit.fit.state.terms.iter().filter(|t| spring(t));
    springs.any(|t| t.coefficient() < 0.0).then(|| {
        format!(
            "{}: springs of negative coefficients: its torques are those that load the joints, not \
             those that the joints hold",
            data.path.display()
        )
    })
}

/// Remarks on holes of plates of which every row is a gross error.
fn wrong_holes(data: &Measurements, best: &Node) -> Vec<String> {
    let mut holes: BTreeMap<(usize, [u64; 3]), (usize, usize)> = BTreeMap::new();
    let at = |row: usize| {
        let row = &data.rows[row];
        let hole = kind(row).hole(row)?;
        Some((*row.refers.first()?, [hole.x, hole.y, hole.z].map(f64::to_bits)))
    };
    for hole in (0..data.rows.len()).filter_map(at) {
        holes.entry(hole).or_default().0 += 1;
    }
    for hole in best.fit.outliers.iter().filter_map(|o| at(o.row)) {
        holes.entry(hole).or_default().1 += 1;
    }
    let wrong = holes.into_iter().filter(|(_, (all, flagged))| *all > 1 && all == flagged);
    let remark = |((plate, hole), (all, _)): ((usize, [u64; 3]), _)| {
        let [x, y, z] = hole.map(|bits| to_mm(f64::from_bits(bits)));
        format!(
            "{}: all {all} rows at the hole at ({x:.3}, {y:.3}, {z:.3}) mm of plate \"{}\" are gross \
             errors: look at its coordinates and its label",
            data.path.display(),
            data.instruments[plate].label
        )
    };
    wrong.map(remark).collect()
}

/// A remark where nobody said what the links weigh: a spring half as stiff under loads half as
/// large bends alike.
fn weightless(best: &Node, weighed: &Weighed) -> Option<String> {
    let assumed = weighed.moments.as_ref().is_some_and(Moments::are_assumed);
    let springs = best.added.iter().any(|candidate| bends(candidate.name()));
    (assumed && springs).then(|| {
        "no [[links]] say what the arm weighs: the +- of springs has a factor that is common to all of \
         them and not known; what they move the target by is known better"
            .to_owned()
    })
}

/// A remark where sides of approach that no column says are in the model.
fn guessed(data: &Measurements, best: &Node) -> Option<String> {
    let depends = |term: &ModelTerm| match term {
        ModelTerm::Arm(term) => term.effect.needs_approach(),
        ModelTerm::Lag { .. } => true,
        ModelTerm::Drift { .. } | ModelTerm::Remount { .. } => false,
    };
    let any = best.fit.fit.state.terms.iter().any(depends);
    (data.directions_from_order && any).then(|| {
        format!(
            "{}: no columns dir1..: the sides from which joints came to rest are taken from the \
             order of the rows",
            data.path.display()
        )
    })
}

/// A remark where a drift by an order that no column says is in the model.
fn numbered(data: &Measurements, best: &Node) -> Option<String> {
    let by_rows = |term: &ModelTerm| term.course().is_some_and(|c| c.clock == Clock::Rows);
    let any = best.fit.fit.state.terms.iter().any(by_rows);
    (data.order_from_rows && any).then(|| {
        format!(
            "{}: no column time_s or order: rows are taken to stand in the order in which they were \
             measured",
            data.path.display()
        )
    })
}

/// A remark where a controller has no room for the model.
fn too_many(best: &Node) -> Option<String> {
    let terms = candidates::arm_terms(&best.added);
    (terms > MAX_TERMS).then(|| {
        format!(
            "{terms} terms of the arm where a controller takes {MAX_TERMS}: --most-terms \
             {MAX_TERMS} gives the best model that can be packed"
        )
    })
}
