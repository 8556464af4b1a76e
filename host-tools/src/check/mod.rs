//! Gross mistakes between a robot file and its measurements, found and named:
//! senses, zeros, orders, units, conventions, signs, hands, rows out of step.
//!
//! Each hypothesis undoes one mistake ([`Mistake`]), is registered and fitted
//! shortly with the links held near nominal and the noise unknown; the most
//! probable one wins if it is more probable than that nothing is wrong. Where one
//! does not do, pairs are tried. What base or tool absorb cannot be seen and is
//! said.

mod absorbed;
mod chains;
mod fit;
mod hypotheses;
mod judged;
pub mod mend;
mod mistake;
mod part;
mod sample;
mod scene;
mod search;
mod stray;
mod suspect;
mod words;

pub use mistake::{AngleUnit, Convention, LengthUnit, Mistake, New};
pub use stray::Stray;
pub use suspect::{Ended, explained, remark};
pub use words::{Said, together};

use nalgebra::Vector3;

use sample::Sample;
use scene::Scene;
use search::{Found, Search};

use crate::error::count;
use crate::model::{Measurements, Robot};

/// An explanation must be this much more probable than a simpler one, nats.
const CLEARLY: f64 = 12.0;
/// Explanations within this of the best one are as good, nats.
const AS_GOOD: f64 = 6.0;
/// A fit that leaves less, m, and corrects by less, tolerances, asks for no
/// second mistake.
const GOOD: (f64, f64) = (2e-3, 12.0);
/// A misfit beyond makes no sense, m: no arm and no effect is that far off...
const SENSELESS: f64 = 0.02;
/// ...nor so far where a coordinate is known so many times better: half of the rows may be
/// another arm's, or another target's, and the fit then lies between the two.
const FAR_FOR_THE_NOISE: (f64, f64) = (5e-3, 50.0);
/// The same over how far the points are spread: an explanation must explain
/// them, not make the arm small.
const EXPLAINED: f64 = 0.05;
/// Corrections beyond are no arm's own, tolerances.
const UNBELIEVABLE: f64 = 100.0;

/// Poses of fewer different joint values agree with nearly any arm, however often
/// each is measured: base and tool alone are nine unknowns.
pub const LEAST_POSES: usize = 6;

/// What there is to say about a robot file and its measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// No gross mistake.
    Sound,
    /// Mistakes were found, and what undoes them.
    Mendable,
    /// They do not agree, and no one or two mistakes say why; or there are too few
    /// poses to tell.
    NotUnderstood,
}

/// What was found.
#[derive(Debug, Clone)]
pub struct Finding {
    /// Whether anything is wrong.
    pub verdict: Verdict,
    /// What undoes it.
    pub changes: Vec<Mistake>,
    /// The same in words.
    pub said: Vec<Said>,
    /// Others that undo it as well: the data cannot tell them from these.
    pub equivalent: Vec<Vec<Said>>,
    /// Misfit of the next explanation that is not as good over that of this
    /// one; none where nothing is wrong.
    pub margin: Option<f64>,
    /// Mistakes that these data cannot show, in words: base or tool absorb them.
    pub absorbed: Vec<String>,
    /// Rows that are far off once the changes are undone; those of the changes
    /// themselves where they are of a part of the rows.
    pub stray: Option<Stray>,
    /// Root mean square misfit as the files are, links within their
    /// tolerances, m; rows far off left out where they are few.
    pub rms_before: f64,
    /// The same with the mistakes undone, m.
    pub rms_after: f64,
    /// Largest correction of the links before, tolerances.
    pub correction_before: f64,
    /// Where the first marker is seen in the last frame, m.
    pub tool: Vector3<f64>,
    /// Poses of different joint values that the measurements have.
    pub poses: usize,
    /// Why nothing can be decided, in words: poses or points are too few, or in one place.
    pub too_few: Option<String>,
}

impl Finding {
    /// Rows that the changes are of, counted from 0; `None` of all.
    #[must_use]
    pub fn only_rows(&self) -> Option<&[usize]> {
        let stray = self.stray.as_ref().filter(|stray| stray.change.is_some());
        stray.filter(|_| self.verdict == Verdict::Mendable).map(|stray| stray.block.as_slice())
    }

    /// Whether the frames of the links are no longer those that the robot file
    /// had, so that centres of mass may be elsewhere.
    #[must_use]
    pub fn moves_frames(&self) -> bool {
        let turns = |c: &Mistake| matches!(c, Mistake::Convention(_) | Mistake::Value(..));
        self.changes.iter().any(turns)
    }
}

/// Looks for gross mistakes.
#[must_use]
pub fn check(robot: &Robot, data: &Measurements) -> Finding {
    let links = robot.nominal();
    let sample = match Sample::of(data, links.iter().map(|link| link.kind).collect()) {
        Ok(sample) => sample,
        Err(why) => return undecided(robot, data, None, why),
    };
    let search = Search { links: &links, tool: robot.tool, sample: &sample };
    let mut nothing = search.nothing();
    if data.poses < LEAST_POSES {
        let poses = count(data.poses, "pose");
        let why = format!(
            "{poses} of different joint values agree with nearly any arm; at least {LEAST_POSES} \
             are needed, better 50"
        );
        return undecided(robot, data, Some(&nothing), why);
    }
    if sample.stands_still() {
        let why = "all points are in one place, whatever the joints did: has the instrument lost \
                   its target? Measure poses spread over the workspace"
            .to_owned();
        return undecided(robot, data, Some(&nothing), why);
    }
    let Ranked { best, all: ranked, unit_is_unseen } = ranked(&search, &mut nothing);
    // Rows of another arm are all far off.
    let stray =
        |of: &Found| (!senseless(of)).then(|| stray::rows(&search, robot, data, of)).flatten();
    let of_best = stray(&best);
    let whole = !best.changes.is_empty() && !of_best.as_ref().is_some_and(|stray| stray.many);
    if let Some(stray) = stray(&nothing).filter(|s| !whole && s.many && s.change.is_some()) {
        return part::finding(robot, data, &search, &nothing, stray);
    }
    let stray = of_best;
    let verdict = match (&best, best.changes.is_empty()) {
        (best, _) if senseless(best) => Verdict::NotUnderstood,
        _ if stray.as_ref().is_some_and(|stray| stray.many) => Verdict::NotUnderstood,
        (_, true) => Verdict::Sound,
        _ => Verdict::Mendable,
    };
    let mut absorbed = absorbed::by_base_or_tool(&search, &nothing, &ranked);
    if unit_is_unseen {
        absorbed.push("unit of the points".to_owned());
    }
    let said = |changes: &[Mistake]| words::said(robot, &sample.kinds, changes);
    let understood = verdict == Verdict::Mendable;
    let others = if understood { others(&best, &ranked) } else { Others::default() };
    let equivalent = others.equivalent.iter().map(|f| said(&f.changes)).collect();
    Finding {
        verdict,
        said: if understood { said(&best.changes) } else { Vec::new() },
        changes: if understood { best.changes.clone() } else { Vec::new() },
        equivalent,
        margin: others.next.map(|next| next.fitted.rms / best.fitted.rms),
        absorbed,
        stray,
        rms_before: nothing.fitted.rms,
        rms_after: best.fitted.rms,
        correction_before: nothing.fitted.correction,
        tool: best.fitted.state.markers.first().copied().unwrap_or(robot.tool),
        poses: data.poses,
        too_few: None,
    }
}

/// Explanations by how probable they are.
struct Ranked {
    best: Found,
    all: Vec<Found>,
    /// Points in another unit fit as well.
    unit_is_unseen: bool,
}

/// The best explanation, and all by how probable they are. One that changes a
/// file wins over a fit of the files as they are only where that rests, begun from
/// its own place as well.
fn ranked(search: &Search, nothing: &mut Found) -> Ranked {
    let mut ones = search.one();
    // Of an arm without lengths points in another unit are those of a larger tool: where one is
    // no worse than the files as they are, and no better, none is believed.
    let mut unit_is_unseen = false;
    if nothing.fitted.is_finest() {
        let is_unit = |one: &Found| one.changes.iter().any(|c| matches!(c, Mistake::PointUnit(_)));
        let (units, others): (Vec<Found>, Vec<Found>) = ones.into_iter().partition(is_unit);
        let gains: Vec<f64> = units.iter().map(|one| search.worse_by(nothing, one)).collect();
        unit_is_unseen = gains.iter().any(|gain| gain.abs() < CLEARLY);
        let better = units.into_iter().zip(gains).filter(|(_, gain)| *gain >= CLEARLY);
        let better = better.map(|(one, _)| one).filter(|_| !unit_is_unseen);
        ones = others.into_iter().chain(better).collect();
        ones.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    }
    if let Some(one) = ones.first().filter(|one| nothing.cost - one.cost >= CLEARLY) {
        let again = search.nothing_from(one);
        if again.cost < nothing.cost {
            *nothing = again;
        }
    }
    let mut best = better(nothing.clone(), ones.first());
    let mut ranked = ones.clone();
    if !good(&best) {
        let twos = search.two(&ones);
        best = better(best, twos.first());
        ranked.extend(twos);
    }
    ranked.push(nothing.clone());
    ranked.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Ranked { best, all: ranked, unit_is_unseen }
}

/// Of too few poses nothing can be said but how well they agree.
fn undecided(robot: &Robot, data: &Measurements, nothing: Option<&Found>, why: String) -> Finding {
    let fitted = nothing.map_or([0.0; 2], |found| [found.fitted.rms, found.fitted.correction]);
    let [rms, correction] = fitted.map(|x| if x.is_finite() { x } else { 0.0 });
    Finding {
        verdict: Verdict::NotUnderstood,
        said: Vec::new(),
        changes: Vec::new(),
        equivalent: Vec::new(),
        margin: None,
        absorbed: Vec::new(),
        stray: None,
        rms_before: rms,
        rms_after: rms,
        correction_before: correction,
        tool: robot.tool,
        poses: data.poses,
        too_few: Some(why),
    }
}

/// Explanations beside the best one.
#[derive(Default)]
struct Others<'a> {
    /// As good as it is.
    equivalent: Vec<&'a Found>,
    /// The next one.
    next: Option<&'a Found>,
}

/// Of ranked explanations. The same number found from another start is no
/// other one.
fn others<'a>(best: &Found, ranked: &'a [Found]) -> Others<'a> {
    let same = |a: &Found, b: &Found| {
        a.changes.len() == b.changes.len()
            && a.changes.iter().all(|a| {
                b.changes.iter().any(|b| match (a, b) {
                    (Mistake::Value(..), Mistake::Value(..)) => a.same_place(b),
                    _ => a == b,
                })
            })
    };
    let mut found = Others::default();
    for other in ranked.iter().filter(|other| !same(other, best)) {
        if other.cost - best.cost >= AS_GOOD {
            found.next = Some(other);
            break;
        }
        let known = found.equivalent.iter().any(|known| same(known, other));
        if !known && other.changes.len() <= best.changes.len() {
            found.equivalent.push(other);
        }
    }
    found
}

/// The other if it is clearly more probable.
fn better(simple: Found, other: Option<&Found>) -> Found {
    match other {
        Some(other) if simple.cost - other.cost >= CLEARLY && explains(other) => other.clone(),
        _ => simple,
    }
}

fn good(found: &Found) -> bool {
    found.fitted.spread <= GOOD.0 && found.fitted.correction <= GOOD.1 && explains(found)
}

fn explains(found: &Found) -> bool {
    !senseless(found) && found.fitted.rms <= EXPLAINED * found.fitted.extent
}

fn senseless(found: &Found) -> bool {
    let (least, sigmas) = FAR_FOR_THE_NOISE;
    let most = (sigmas * found.fitted.sigma).clamp(least, SENSELESS);
    found.fitted.rms > most || found.fitted.correction > UNBELIEVABLE
}

/// Robot and rows with the mistakes undone.
fn undone(robot: &Robot, changes: &[Mistake]) -> Robot {
    let nothing =
        Sample { kinds: Vec::new(), stations: 0, markers: 0, sigma: 0.0, rows: Vec::new() };
    let scene = Scene::new(&robot.nominal(), robot.tool, &nothing, changes);
    let mut robot = robot.clone();
    robot.joints.iter_mut().zip(scene.links).for_each(|(joint, link)| joint.link = link);
    robot.tool = scene.tool;
    robot
}
