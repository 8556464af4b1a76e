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
mod explanations;
mod finding;
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

pub use finding::{Finding, Verdict};
pub use mistake::{AngleUnit, Convention, LengthUnit, Mistake, New};
pub use stray::Stray;
pub use suspect::{Ended, explained, remark};
pub use words::{Said, together};

use explanations::{Others, Ranked, others, ranked, senseless};
use sample::Sample;
use search::{Found, Search};

use crate::error::count;
use crate::model::{Measurements, Robot};

/// Poses of fewer different joint values agree with nearly any arm, however often
/// each is measured: base and tool alone are nine unknowns.
pub const LEAST_POSES: usize = 6;

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
    if let Some(why) = too_few(data, &sample) {
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

/// Why poses or points do not suffice, if so.
fn too_few(data: &Measurements, sample: &Sample) -> Option<String> {
    if data.poses < LEAST_POSES {
        let poses = count(data.poses, "pose");
        return Some(format!(
            "{poses} of different joint values agree with nearly any arm; at least {LEAST_POSES} \
             are needed, better 50"
        ));
    }
    sample.stands_still().then(|| {
        "all points are in one place, whatever the joints did: has the instrument lost its target? \
         Measure poses spread over the workspace"
            .to_owned()
    })
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
