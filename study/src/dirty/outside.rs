//! What a diagnosis of an arm with something outside the repertoire says of it.

use truearm_host::diagnose::{Described, DiagnoseOptions, Outcome, Verdict, diagnose};
use truearm_simulate::effects::{DefectKind, Outside};

use super::set::{DirtySet, Sort};
use super::told::alone;
use super::truth::Place;
use crate::blind::score::of;

/// A set and what was said of it.
#[derive(Debug)]
pub struct Answer {
    pub seed: u64,
    pub rows: usize,
    /// Word of the kind.
    pub kind: &'static str,
    /// How far what has no name is from nothing, everything else unknown, in standard
    /// deviations; the same from nothing or any effect with a name; and in noise floors.
    pub from_nothing: f64,
    pub sure: f64,
    pub floors: f64,
    pub verdict: Verdict,
    /// Whether the part and what it goes with are said.
    pub right: bool,
    /// Everything that is described: part, its joint, with what, that one's joint.
    pub described: Vec<(&'static str, Option<usize>, &'static str, Option<usize>)>,
    /// Names that the arm does not have.
    pub wrong: Vec<Place>,
    /// Of the effects that have a name: how many, and how many are named.
    pub named: [usize; 2],
}

/// Diagnoses the set of a seed.
///
/// # Errors
/// The diagnosis', with the seed.
///
/// # Panics
/// Never: such a set has something outside.
pub fn answer(seed: u64) -> Result<Answer, String> {
    let set = DirtySet::draw(seed, Sort::Outside);
    let (robot, [data, _]) = set.read();
    let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ());
    let report = found.map_err(|e| format!("seed {seed}: {e}"))?.outcome;
    let hidden = &set.open().hidden;
    let Some((kind, defects)) = &hidden.unlisted else { return Err(format!("seed {seed}")) };
    let Some(DefectKind::Outside(outside)) = defects.first().map(|d| &d.kind) else {
        return Err(format!("seed {seed}"));
    };
    let alone = alone(&set).ok_or_else(|| format!("seed {seed}: not registered"))?;
    let [from_nothing, sure] = alone.last().map_or([0.0; 2], |a| [a.from_nothing, a.sure]);
    let there =
        |p: &Place| hidden.listed.iter().any(|d| d.kind.name() == p.0 && d.kind.joints() == p.1);
    let claims = of(&report.effects);
    let named = claims.iter().filter(|p| there(p)).count();
    Ok(Answer {
        seed,
        rows: data.rows.len(),
        kind,
        from_nothing,
        sure,
        floors: from_nothing / (3.0 * data.rows.len() as f64).sqrt(),
        verdict: report.verdict,
        right: says(&report, outside),
        described: report.described.iter().map(place).collect(),
        wrong: claims.into_iter().filter(|p| p.0 != "outliers" && !there(p)).collect(),
        named: [hidden.listed.len(), named],
    })
}

fn place(d: &Described) -> (&'static str, Option<usize>, &'static str, Option<usize>) {
    (d.part, d.joint, d.with, d.with_joint)
}

/// Whether a report points at what errs and what it goes with.
fn says(report: &Outcome, outside: &Outside) -> bool {
    let (with, with_joint) = outside.with();
    let right = |d: &Described| {
        // A pedestal leans as joint 1 turns, and what stands on it shifts; that joint's axis
        // tilts then as it turns, which is the same.
        if outside.part() == "base" {
            let first = d.part == "axis" && d.joint == with_joint;
            return (first || d.part.starts_with("base")) && d.with_joint == with_joint;
        }
        let with = match with {
            "angle" => d.with == "joint" && d.with_joint == with_joint,
            other => d.with == other,
        };
        d.part == outside.part() && d.joint == outside.joint() && with
    };
    report.described.iter().any(right)
}
