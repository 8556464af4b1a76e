//! What a diagnosis of a dirty set was worth.

use truearm_host::diagnose::{DiagnoseOptions, Doubt, Effect, Outcome, Verdict, diagnose};
use truearm_host::effects::OUTLIERS;
use truearm_host::model::CURVE;
use truearm_simulate::effects::{Defect, DefectKind};

use super::set::DirtySet;
use super::told::alone;
use super::truth::{Place, attainable, floors};
use crate::apart::TOLD;
use crate::blind::score::of;

/// What a claim was worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Worth {
    /// The arm has it.
    True,
    /// It has not.
    False,
    /// A periodic part of a joint whose error curve has no name: neither.
    OfACurve,
}

/// A claim of a report.
#[derive(Debug, Clone)]
pub struct Claimed {
    pub place: Place,
    pub probability: f64,
    /// Named, or only suspected.
    pub named: bool,
    /// Why, however probable.
    pub doubt: Option<Doubt>,
    pub worth: Worth,
    /// It is not there, but nobody could tell it from what is and has no name.
    pub alike: bool,
}

/// A hidden effect.
#[derive(Debug, Clone)]
pub struct Truth {
    pub place: Place,
    /// Its size, in noise floors.
    pub floors: f64,
    pub named: bool,
    /// It stands in an alternative.
    pub told: bool,
    /// How far it is from nothing, and from nothing or any one rival, see [`crate::apart`].
    pub from_nothing: f64,
    pub sure: f64,
    /// Of a spring that is named of an arm with masses: what was found less what is, in
    /// stated standard deviations.
    pub off: Option<f64>,
}

/// A set and its answer.
#[derive(Debug, Clone)]
pub struct Judged {
    pub seed: u64,
    pub rows: usize,
    pub verdict: Verdict,
    pub claims: Vec<Claimed>,
    pub truths: Vec<Truth>,
    pub unlisted: Option<&'static str>,
    /// Hold-out RMS of the answer over the attainable one.
    pub ratio: Option<f64>,
    /// Stated noise scale over the true one.
    pub scale: f64,
}

/// All that can be judged.
pub fn claims<'j>(sets: &[&'j Judged]) -> Vec<&'j Claimed> {
    sets.iter().flat_map(|j| &j.claims).filter(|c| c.worth != Worth::OfACurve).collect()
}

impl Truth {
    /// Whether anyone could name it who is told everything else.
    pub fn can_be_told(&self) -> bool {
        self.sure >= TOLD
    }
}

/// Diagnoses a set and compares.
///
/// # Errors
/// The diagnosis', with the seed.
pub fn judged(set: &DirtySet) -> Result<Judged, String> {
    let (robot, [data, holdout]) = set.read();
    let found = diagnose(&robot, &data, Some(&holdout), &DiagnoseOptions::default(), &|_| ());
    let report = found.map_err(|e| format!("seed {}: {e}", set.seed))?.outcome;
    let secret = set.open();
    let noise = &secret.noise;
    let place = |kind: &DefectKind| (kind.name().to_owned(), kind.joints());
    let alone = alone(set).ok_or_else(|| format!("seed {}: not registered", set.seed))?;
    let sized = secret.hidden.listed.iter().zip(floors(set));
    let truths = sized.zip(&alone).map(|((d, floors), alone)| Truth {
        place: place(&d.kind),
        floors,
        named: of(&report.effects).contains(&place(&d.kind)),
        told: told(&report, &place(&d.kind)),
        from_nothing: alone.from_nothing,
        sure: alone.sure,
        off: robot.gravity.and_then(|_| off(&report, d)),
    });
    let truths: Vec<Truth> = truths.collect();
    let curve = match &secret.hidden.unlisted {
        Some(("joint error curve", lines)) => lines.first().map(|d| d.kind.joints()),
        _ => None,
    };
    let without_name = (0..alone.len()).filter(|k| truths.get(*k).is_none_or(|t| !t.named));
    let alike: Vec<&Place> = without_name.flat_map(|k| &alone[k].alike).collect();
    let claims = [(&report.effects, true), (&report.suspected, false)];
    let claims = claims.into_iter().flat_map(|(effects, named)| {
        let own = effects.iter().filter(|e| e.name != OUTLIERS);
        own.flat_map(move |e| of(std::slice::from_ref(e)).into_iter().map(move |p| (p, e, named)))
    });
    let mut out: Vec<Claimed> = Vec::new();
    for (place, effect, named) in claims {
        if out.iter().any(|c| c.place == place) {
            continue;
        }
        let worth = worth(&place, &truths, curve.as_ref());
        let Effect { probability, doubt, .. } = *effect;
        let alike = worth == Worth::False && alike.contains(&&place);
        out.push(Claimed { place, probability, named, doubt, worth, alike });
    }
    let reached = report.gap.last().and_then(|row| row.holdout_rms_mm);
    Ok(Judged {
        seed: set.seed,
        rows: data.rows.len(),
        verdict: report.verdict,
        claims: out,
        truths,
        unlisted: secret.hidden.unlisted.as_ref().map(|u| u.0),
        ratio: attainable(set).and_then(|a| Some(reached? * 1e-3 / a)),
        scale: report.noise_scale * noise.stated / noise.of_pose.hypot(noise.of_reading),
    })
}

/// Of a name at a place, if the arm's unlisted effect is a curve of these joints.
fn worth(place: &Place, truths: &[Truth], curve: Option<&Vec<usize>>) -> Worth {
    let periodic = ["joint-periodic-error", "encoder-eccentricity", "gear-transmission-error"];
    let there = curve == Some(&place.1);
    match place.0.as_str() {
        _ if truths.iter().any(|t| t.place == *place) => Worth::True,
        CURVE if there => Worth::True,
        name if there && periodic.contains(&name) => Worth::OfACurve,
        _ => Worth::False,
    }
}

fn off(report: &Outcome, defect: &Defect) -> Option<f64> {
    let DefectKind::JointCompliance { .. } = defect.kind else { return None };
    let own = |e: &&Effect| e.name == defect.kind.name() && e.joints == defect.kind.joints();
    let found = report.effects.iter().find(own)?.coefficients.first()?;
    Some((found.value - defect.size) / found.sigma)
}

/// Whether a place stands in an alternative or among what is suspected.
fn told(report: &Outcome, place: &Place) -> bool {
    let mut all = report.alternatives.iter().flat_map(|a| &a.effects);
    all.any(|(name, joints)| *name == place.0 && *joints == place.1)
        || of(&report.suspected).contains(place)
}
