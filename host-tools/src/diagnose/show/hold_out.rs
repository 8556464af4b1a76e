//! Poses of a file that nothing was fitted to, in the frames of the training.

use super::gap::{Show, rms};
use crate::diagnose::node::Node;
use crate::diagnose::outcome::HoldOut;
use crate::error::{Error, ErrorKind, Label, Result};
use crate::evaluate::{known_instruments, own_evidence, residuals};
use crate::identify::{Conditions, Layout, State};
use crate::model::{ErrorCurve, Measurements};
use crate::observations::Residual;

impl Show<'_> {
    /// Its rows that stand out from the final model, and what they do to its figure.
    ///
    /// # Errors
    /// A hold-out file of unknown stations.
    pub fn hold_out(&self, best: &Node) -> Result<Option<HoldOut>> {
        let Some(holdout) = self.holdout else { return Ok(None) };
        let all = self.on_holdout(holdout, self.tables, &best.fit.fit.state)?;
        let out = own_evidence(holdout, &all);
        let all: Vec<_> = all.into_iter().map(Some).collect();
        let of_all = rms(holdout, &self.rigid.noise, &all, &[]);
        let numbered = |rows: Vec<usize>| rows.into_iter().map(|row| row + 1).collect();
        Ok(Some(HoldOut {
            file: holdout.path.display().to_string(),
            rows: holdout.rows.len(),
            left_out: numbered(out.left_out),
            standing_out: numbered(out.counted),
            all_rows_rms_mm: of_all.mm,
            all_rows_rms_sigmas: of_all.sigmas,
        }))
    }

    /// Refuses rows that tell where a station stands which the training left where the
    /// robot file has it.
    fn stands_somewhere(&self, holdout: &Measurements) -> Result<()> {
        let data = self.question.problem.data;
        let known = |label: &String| {
            let place = data.stations.iter().position(|l| l == label);
            place.is_some_and(|s| self.rigid.unknowns.station(s).is_some())
        };
        let of = Layout::of(holdout).stations;
        let asked = holdout.stations.iter().zip(of).find(|(label, tells)| *tells && !known(label));
        match asked {
            None => Ok(()),
            Some((label, _)) => Err(Error::data(
                ErrorKind::UnknownStation,
                format!(
                    "{}: rows that are measured in the frame of station \"{label}\", which no row of \
                     the training tells",
                    holdout.path.display()
                ),
                JUDGED,
            )),
        }
    }

    /// Residuals of a hold-out file in the frames of the training.
    pub(super) fn on_holdout(
        &self,
        holdout: &Measurements,
        tables: &[ErrorCurve],
        state: &State,
    ) -> Result<Vec<Residual>> {
        let data = self.question.problem.data;
        let place = |known: &[String], label: &String, what: Label| {
            known.iter().position(|l| l == label).ok_or_else(|| unknown_label(holdout, what, label))
        };
        let mut bases = Vec::new();
        for label in &holdout.stations {
            bases.push(state.bases[place(&data.stations, label, Label::Station)?]);
        }
        let mut markers = Vec::new();
        for label in &holdout.markers {
            markers.push(state.markers[place(&data.markers, label, Label::Marker)?]);
        }
        self.stands_somewhere(holdout)?;
        let instruments = known_instruments(&state.instruments, holdout, JUDGED)?;
        let state = State { bases, markers, instruments, ..state.clone() };
        let conditions = Conditions::at(holdout, self.robot, &state.links);
        let conditions = conditions.with_curves(holdout, tables);
        Ok(residuals(holdout, &conditions, &state))
    }
}

/// What to do where a hold-out file refers to something else.
const JUDGED: &str = "hold out rows of the kinds, anchors, surfaces and plates that the training has, \
                      state this one in instruments.toml, or give some of these rows to the \
                      training; `truearm evaluate --reregister base+tool` finds it on the file itself";

/// A station or marker of a hold-out file that the training did not have.
fn unknown_label(data: &Measurements, of: Label, label: &str) -> Error {
    let what = of.name();
    let refit = if of == Label::Marker { "base+tool" } else { "base" };
    Error::data(
        of.unknown(),
        format!("{}: {what} \"{label}\" is not in the training data", data.path.display()),
        format!(
            "hold-out poses are judged in the frames of the training; for another {what} use \
             `truearm evaluate --reregister {refit}`"
        ),
    )
}
