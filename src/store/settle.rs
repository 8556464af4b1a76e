//! How what a store left unfinished is ended or undone at power-up.

use super::marks::Mark;
use super::medium::{Medium, Slot};
use super::report::{Progress, Settled, SlotState, WriteError};
use super::slot::{Held, Store};
use crate::blob::Blob;

/// The valid blob that is returned.
#[derive(Clone, Copy)]
pub(super) struct Chosen {
    pub slot: Slot,
    pub sequence: u32,
    pub progress: Progress,
    pub copies: u8,
}

impl<M: Medium> Store<M> {
    /// Ends or undoes what a store left unfinished. The bytes of the chosen blob,
    /// if any, are in the buffer.
    pub(super) fn settle(
        &mut self,
        chosen: Option<Chosen>,
        states: &[SlotState<M::Error>; 2],
        buffer: &[u8],
    ) -> Settled<M::Error> {
        let chosen = match chosen {
            Some(chosen) => {
                self.live = Some((chosen.slot, chosen.sequence));
                chosen
            }
            None => return self.undo(states),
        };
        if chosen.progress == Progress::Done {
            return self.undo(states);
        }
        let size = Blob::check(buffer).map_or(0, |blob| blob.size());
        match self.finish(chosen, states, buffer.get(..size).unwrap_or(&[])) {
            Ok(slot) => {
                self.live = Some((slot, chosen.sequence));
                Settled::Rewritten
            }
            Err(error) => Settled::Failed(error),
        }
    }

    /// Writes the chosen blob anew; where it then is.
    fn finish(
        &mut self,
        chosen: Chosen,
        states: &[SlotState<M::Error>; 2],
        bytes: &[u8],
    ) -> Result<Slot, WriteError<M::Error>> {
        let Chosen { slot, sequence, progress, copies } = chosen;
        let torn = progress == Progress::Committing;
        let other = slot.other();
        let fallback = match other.of(states.each_ref()) {
            SlotState::Valid { sequence: older, .. } => *older < sequence,
            // Nothing is left if it is lost, but that was so before its store.
            _ => other.of(self.held) != Held::Free,
        };
        if !(torn && fallback) {
            // It is solid, or nothing is left if it is lost.
            let copy = Mark::Begun { copies: copies.saturating_add(1) };
            match self.write(other, copy, bytes) {
                Ok(()) => return Ok(other),
                // No place for a copy, as if it were not the store's to erase.
                Err(WriteError::ReadBack(_)) if torn => (),
                Err(error) => return Err(error),
            }
        }
        self.write(slot, Mark::Begun { copies }, bytes).map(|()| slot)
    }

    /// Erases what a store began and was cut or damaged before it ended.
    fn undo(&mut self, states: &[SlotState<M::Error>; 2]) -> Settled<M::Error> {
        let [a, b] = states;
        match (self.undo_in(Slot::A, a), self.undo_in(Slot::B, b)) {
            (Err(error), _) | (_, Err(error)) => Settled::Failed(error),
            (Ok(false), Ok(false)) => Settled::Already,
            _ => Settled::Erased,
        }
    }

    /// The same in one slot; whether it was erased.
    #[inline(never)]
    fn undo_in(
        &mut self,
        slot: Slot,
        state: &SlotState<M::Error>,
    ) -> Result<bool, WriteError<M::Error>> {
        let held = slot.of(self.held);
        if held == Held::Foreign || !matches!(state, SlotState::Rejected(_)) {
            return Ok(false);
        }
        match self.marks(slot) {
            Ok(Some(marks)) if marks.progress == Progress::Committing => {
                self.clear(slot).map(|()| true)
            }
            Err(fault) if held == Held::Free => Err(WriteError::Fault(fault)),
            _ => Ok(false),
        }
    }
}
