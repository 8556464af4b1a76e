//! What a check says.

use nalgebra::Vector3;

use super::mistake::Mistake;
use super::stray::Stray;
use super::words::Said;

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
