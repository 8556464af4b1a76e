//! Two blobs side by side: which parameters moved, and the tool with them.

mod beyond;
mod motion;
mod moved;
mod parameters;

use schemars::JsonSchema;
use serde::Serialize;
use truearm::blob::Blob;
use truearm_sized::Parameters;

pub use motion::Motion;
use moved::Moved;
use parameters::parameters;

use super::describe::{rms, term_columns};
use crate::error::{Error, ErrorKind, Result};

/// What two blobs differ by.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct Difference {
    /// Whether the parameters are the same, bit by bit.
    pub same: bool,
    /// What moved, by more than the last decimal in words.
    pub changes: Vec<Change>,
    /// How many numbers moved by less.
    pub little: usize,
    /// How far the tool moves, in the joint limits and in what both covered.
    pub motions: Vec<Motion>,
    /// All of it in words.
    #[serde(skip)]
    pub words: String,
}

/// A parameter before and after; none where there is none.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Change {
    /// The parameter.
    pub what: String,
    /// Its unit; empty of words.
    pub unit: &'static str,
    /// In the blob before.
    pub before: Option<Told>,
    /// In the blob after.
    pub after: Option<Told>,
}

/// A number, or words.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Told {
    /// In the unit of the change.
    Number(f64),
    /// Such as a range or a curve.
    Text(String),
}

/// The differences in words, see [`difference`].
///
/// # Errors
/// As for [`difference`].
pub fn diff(before: &[u8], after: &[u8], poses: usize, seed: u64) -> Result<String> {
    Ok(difference(before, after, poses, seed)?.words)
}

/// The differences. The tool's motion is that over a seeded draw of
/// poses within the limits of the joints (where there are none, the ranges the
/// identification covered), each in a state of its own.
///
/// # Errors
/// A blob that a controller would refuse, or two of different joint counts.
pub fn difference(before: &[u8], after: &[u8], poses: usize, seed: u64) -> Result<Difference> {
    let check = |bytes, which| {
        Blob::check(bytes).map_err(|e| {
            Error::data(
                ErrorKind::Refused,
                format!("the blob {which}: {e}"),
                "see `truearm inspect`",
            )
        })
    };
    let (a, b) = (check(before, "before")?, check(after, "after")?);
    if a.joints() != b.joints() {
        return Err(Error::data(
            ErrorKind::OtherArm,
            format!("{} joints before, {} after", a.joints(), b.joints()),
            "only blobs of the same arm can be compared",
        ));
    }
    let mut out = Moved::default();
    let ids = [a.robot_id(), b.robot_id()].map(|id| format!("{id:#018x}"));
    if ids[0] != ids[1] {
        out.text += &format!("different robots: {}, {}\n", ids[0], ids[1]);
        out.told("robot id", ids);
    }
    if a.sequence() != b.sequence() {
        out.text += &format!("sequence {} -> {}\n", a.sequence(), b.sequence());
        out.told("sequence", [a.sequence(), b.sequence()].map(|n| n.to_string()));
    }
    let content = |blob: &Blob, bytes: &[u8]| blob.content().map(|part| bytes[part].to_vec());
    if content(&a, before) == content(&b, after) {
        out.text += "the parameters are the same\n";
        return Ok(out.difference(true, Vec::new()));
    }
    if a.covariance().is_some() != b.covariance().is_some() {
        out.text += &format!("covariance {} -> {}\n", has(&a), has(&b));
        out.told("covariance", [&a, &b].map(|blob| has(blob).to_owned()));
    }
    let fail = |e| Error::data(ErrorKind::Refused, format!("{e}"), "see `truearm inspect`");
    let (a, b) = (Parameters::read(&a).map_err(fail)?, Parameters::read(&b).map_err(fail)?);
    parameters(&mut out, &a, &b);
    let motions = motion::motion(&mut out.text, &a, &b, (poses, seed));
    Ok(out.difference(false, motions))
}

fn has(blob: &Blob) -> &'static str {
    if blob.covariance().is_some() { "present" } else { "absent" }
}
