//! Whether anything but noise is left.

use super::crowd::crowded;
use super::described::Described;
use super::node::Node;
use super::noise_remarks;
use super::onset;
use super::outcome::{GapRow, Verdict};
use super::policy::POLICY;
use super::remarks::over_repeats;
use super::weigh::Weighed;
use super::white;
use crate::identify::Problem;

/// The verdict on a model, and in words what it leaves: structure without a name
/// that is more probable than not, neighbours that are alike, and, where nothing is named, what
/// the residuals of geometry alone go with, `goes_with`, beyond any chance. How large the
/// rest is has no part in it, as nobody knows the noise, unless it is beyond what any
/// instrument is misstated by.
#[must_use]
pub fn verdict(
    problem: &Problem,
    (weighed, described): (&Weighed, &[Described]),
    (best, gross): (&Node, f64),
    gap: &[GapRow],
    goes_with: Option<String>,
) -> (Verdict, Vec<String>) {
    let mut left: Vec<String> = described.iter().map(|d| d.words.clone()).collect();
    let alike = white::left(problem, best).filter(|a| a.deviations > POLICY.white);
    left.extend(alike.map(|a| a.words()));
    let noise = weighed.scale * problem.noise.middle(problem.data);
    if noise > POLICY.far_off {
        left.push(format!(
            "the rest, {noise:.0} times the stated standard deviation: that, the arm's drawing or the \
             files are wrong, see truearm check"
        ));
    }
    let over = over_repeats(problem, best).filter(|_| noise > POLICY.beyond_stated);
    left.extend(over.map(|times| {
        format!(
            "poses are off by {times:.1} times what their repeats scatter, and by {noise:.1} times \
             the stated standard deviation"
        )
    }));
    left.extend(too_few(problem, gap, noise));
    if noise > POLICY.beyond_stated {
        left.extend(
            noise_remarks::joints(weighed).map(|joint| noise_remarks::scatters(problem, joint)),
        );
    }
    left.extend(onset::all(problem, best, &weighed.scattering));
    // What geometry alone leaves, where nothing was added to it and nothing is described.
    let alone = best.added.is_empty() && weighed.curves.is_empty() && described.is_empty();
    left.extend(goes_with.filter(|_| alone));
    if left.is_empty() && crowded(problem, best) {
        left.push(CROWDED.to_owned());
    }
    if weighed.no_room > 0 && best.added.is_empty() {
        left.push(format!("{} effects that --most-terms has no room for", weighed.no_room));
    }
    let verdict = if !left.is_empty() {
        Verdict::Unexplained
    } else if best.added.is_empty() && gross < POLICY.named && weighed.curves.is_empty() {
        Verdict::Clean
    } else {
        Verdict::Explained
    };
    (verdict, left)
}

/// What flagged rows have together may be anything.
const CROWDED: &str =
    "more rows do not fit, or they lie nearer to each other, than gross errors do";

/// Where poses held out say that so few tell nothing: a fit of as many unknowns as there are
/// equations leaves nothing, and is no evidence that nothing is missing.
fn too_few(problem: &Problem, gap: &[GapRow], noise: f64) -> Option<String> {
    let last = gap.last()?;
    let held = last.cross_validated_rms_sigmas?;
    let times = held / last.train_rms_sigmas.max(f64::MIN_POSITIVE);
    (times > POLICY.beyond_fitted && held * noise > POLICY.beyond_stated).then(|| {
        format!(
            "poses held out are missed by {times:.0} times what fitted ones are: {} poses are too \
             few to tell what {} unknowns do, measure more",
            problem.data.poses,
            problem.unknowns.list().len()
        )
    })
}
