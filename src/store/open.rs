use super::medium::{MAX_WORD, Medium, Slot};
use super::report::{Opened, Progress, Rejection, Settled, SlotState, Source, WriteError};
use super::write::{Mark, Marks};
use crate::blob::{Acceptance, Blob, DecodeError, Refusal};

/// How often a slot is read until two readings agree.
const READINGS: usize = 8;

/// Two slots, of which one may be in use.
#[derive(Debug)]
pub struct Store<M> {
    pub(super) medium: M,
    pub(super) accept: Acceptance,
    /// The slot whose blob `open` returned or `store` wrote; its sequence.
    pub(super) live: Option<(Slot, u32)>,
    /// Whether what `open` returned will last.
    pub(super) settled: bool,
}

impl<M: Medium> Store<M> {
    /// Power-up: reads both slots, each until two readings agree, and returns
    /// the newest valid and accepted blob, after ending or undoing what a
    /// store left unfinished (see the [module](super)).
    ///
    /// `buffer` needs the size of the largest blob, rounded up to whole write
    /// words; a longer blob is refused as [`DecodeError::Truncated`]. `accept`
    /// says whose blobs are taken, here and by [`Store::store`].
    ///
    /// Cannot fail: without a valid blob the answer is [`Source::Nominal`],
    /// with the reasons. Reads each slot two to four times.
    pub fn open<'b>(medium: M, buffer: &'b mut [u8], accept: Acceptance) -> (Self, Opened<'b>) {
        let mut store = Self { medium, accept, live: None, settled: true };
        let mut states = [Slot::A, Slot::B].map(|slot| store.examine(slot, buffer));
        let mut chosen = None;
        while let (Some(slot), None) = (newest(&states), chosen) {
            // The buffer may hold the other slot, and a torn one may have changed.
            let again = store.examine(slot, buffer);
            match again {
                SlotState::Valid { .. } => chosen = Some((slot, again)),
                _ => slot.replace(&mut states, SlotState::Rejected(Rejection::Unstable)),
            }
        }
        let (live, settled) = store.settle(chosen, &states, buffer);
        store.settled = !matches!(settled, Settled::Failed(_));
        store.live = live;
        let source = match chosen {
            None => Source::Nominal(states),
            Some((slot, _)) => match slot.other().of(states) {
                SlotState::Rejected(rejected) => Source::LastGood { slot, rejected },
                _ => Source::Newest(slot),
            },
        };
        let blob = chosen.and_then(|_| Blob::check(buffer).ok());
        (store, Opened { blob, source, settled })
    }

    /// The memory, for other uses.
    pub fn release(self) -> M {
        self.medium
    }

    /// The slot in use and the sequence number of its blob.
    #[must_use]
    pub fn live(&self) -> Option<(Slot, u32)> {
        self.live
    }

    /// Reads a slot into the buffer and judges it.
    fn examine(&mut self, slot: Slot, buffer: &mut [u8]) -> SlotState {
        let words = buffer.len().min(self.room()) / M::WORD * M::WORD;
        let bytes = buffer.get_mut(..words).unwrap_or(&mut []);
        if let Err(rejection) = self.read_stable(slot, bytes) {
            return SlotState::Rejected(rejection);
        }
        match self.accept.check(bytes) {
            Ok(blob) => {
                let sequence = blob.sequence();
                let blob = bytes.get(..blob.size()).unwrap_or(bytes);
                let last = blob.last_chunk();
                match self.marks(slot).filter(|marks| Some(&marks.last) == last) {
                    Some(Marks { progress, copies, .. }) => {
                        SlotState::Valid { sequence, progress, copies }
                    }
                    None => SlotState::Valid { sequence, progress: Progress::Done, copies: 0 },
                }
            }
            Err(Refusal::Damaged(DecodeError::NotABlob)) if self.is_blank(slot) => SlotState::Blank,
            Err(refusal) => SlotState::Rejected(Rejection::Blob(refusal)),
        }
    }

    fn read_stable(&mut self, slot: Slot, bytes: &mut [u8]) -> Result<(), Rejection> {
        for _ in 0..READINGS {
            self.medium.read(slot, 0, bytes).map_err(Rejection::Fault)?;
            match self.compare(slot, bytes, |_| true) {
                Ok(true) => return Ok(()),
                Err(WriteError::Fault(fault)) => return Err(Rejection::Fault(fault)),
                _ => (),
            }
        }
        Err(Rejection::Unstable)
    }

    fn is_blank(&mut self, slot: Slot) -> bool {
        let size = self.medium.slot_size();
        let mut bytes = [0; MAX_WORD];
        for start in (0..size).step_by(MAX_WORD) {
            let piece = bytes.get_mut(..MAX_WORD.min(size - start)).unwrap_or(&mut []);
            if self.medium.read(slot, start, piece).is_err() || piece.iter().any(|b| *b != 0xff) {
                return false;
            }
        }
        true
    }

    /// Ends or undoes what a store left unfinished; where the chosen blob is
    /// then, and its sequence number. Its bytes are in the buffer.
    fn settle(
        &mut self,
        chosen: Option<(Slot, SlotState)>,
        states: &[SlotState; 2],
        buffer: &[u8],
    ) -> (Option<(Slot, u32)>, Settled) {
        let Some((slot, SlotState::Valid { sequence, progress, copies })) = chosen else {
            return (None, self.undo(states));
        };
        let live = Some((slot, sequence));
        if progress == Progress::Done {
            return (live, self.undo(states));
        }
        let fallback = match slot.other().of(*states) {
            SlotState::Valid { sequence: older, .. } => older < sequence,
            _ => false,
        };
        let (target, copies) = if progress == Progress::Committing && fallback {
            (slot, copies)
        } else {
            // It is solid, or nothing is left if it is lost.
            (slot.other(), copies.saturating_add(1))
        };
        let size = Blob::check(buffer).map_or(0, |blob| blob.size());
        match self.write(target, Mark::Begun { copies }, buffer.get(..size).unwrap_or(&[])) {
            Ok(()) => (Some((target, sequence)), Settled::Rewritten),
            Err(error) => (live, Settled::Failed(error)),
        }
    }

    /// Erases what a store began and holds no valid blob.
    fn undo(&mut self, states: &[SlotState; 2]) -> Settled {
        let mut settled = Settled::Already;
        for slot in [Slot::A, Slot::B] {
            let rejected = matches!(slot.of(*states), SlotState::Rejected(_));
            let begun = |marks: Marks| marks.progress == Progress::Committing;
            if rejected && self.marks(slot).is_some_and(begun) {
                settled = match self.medium.erase(slot) {
                    Ok(()) => Settled::Erased,
                    Err(fault) => return Settled::Failed(WriteError::Fault(fault)),
                };
            }
        }
        settled
    }
}

/// The slot of the newest valid blob. Of two alike a solid one; of two solid
/// ones the copy, for its original may have been erased since, in part; of two
/// others the original.
fn newest(states: &[SlotState; 2]) -> Option<Slot> {
    let key = |state| match state {
        SlotState::Valid { sequence, progress: Progress::Committing, copies } => {
            Some((sequence, false, u8::MAX - copies))
        }
        SlotState::Valid { sequence, copies, .. } => Some((sequence, true, copies)),
        _ => None,
    };
    let [a, b] = states.map(key);
    match (a, b) {
        (None, None) => None,
        (a, b) if a >= b => Some(Slot::A),
        _ => Some(Slot::B),
    }
}
