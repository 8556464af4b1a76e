use super::marks::{Mark, Marks, last_four};
use super::medium::{Fault, GeometryError, MAX_WORD, Medium, Slot, is_word};
use super::report::{Opened, Progress, Rejection, Settled, SlotState, Source, WriteError};
use super::slot::Store;
use crate::arm::MAX_JOINTS;
use crate::blob::{Acceptance, AcceptanceError, Blob, DecodeError, Frame, LAYOUT};

/// How often a slot is read until two readings agree.
const READINGS: usize = 8;

/// What [`Store::open`] gives.
type Open<'b, M> = (Store<M>, Opened<'b, <M as Medium>::Error>);

impl<M: Medium> Store<M> {
    /// Power-up: reads both slots, each until two readings agree, and returns
    /// the newest valid and accepted blob, after ending or undoing what a
    /// store left unfinished (see the [module](super)).
    ///
    /// This is the contract that the store keeps from here on: `accept` says
    /// whose blobs are taken, of how many joints; `buffer` how long a blob may
    /// be, in whole write words. [`Store::store`] takes nothing that the next
    /// `open` with the same two would refuse. A whole blob in a slot that they
    /// refuse (longer than the buffer, another robot's or layout...) is left
    /// alone, here and by `store`.
    ///
    /// Reads each slot two to five times where readings agree; an unstable one up to
    /// sixteen times, and once more as often where it is then to be used.
    ///
    /// # Errors
    /// [`GeometryError::Joints`], [`GeometryError::Buffer`],
    /// [`GeometryError::Slot`]: not even the shortest blob of such an arm would
    /// fit. Nothing has been read then, and whatever the memory holds it is no
    /// error: without a valid blob the answer is [`Source::Nominal`], with the
    /// reasons.
    pub fn open<'b>(
        medium: M,
        buffer: &'b mut [u8],
        accept: Acceptance,
    ) -> Result<Open<'b, M>, GeometryError> {
        const { assert!(is_word(M::WORD), "a write word must be a power of two up to MAX_WORD") };
        let mut store =
            Self { medium, accept, longest: 0, live: None, occupied: [false; 2], settled: true };
        store.longest = store.longest_blob(buffer)?;
        let mut states = [Slot::A, Slot::B].map(|slot| store.examine(slot, buffer));
        let mut chosen = None;
        while let (Some(slot), None) = (newest(&states), chosen) {
            // The buffer may hold the other slot, and a torn one may have changed.
            match store.examine(slot, buffer) {
                SlotState::Valid { sequence, progress, copies } => {
                    chosen = Some(Chosen { slot, sequence, progress, copies });
                }
                SlotState::Blank => {
                    slot.replace(&mut states, SlotState::Rejected(Rejection::Unstable));
                }
                rejected => slot.replace(&mut states, rejected),
            }
        }
        let [a, b] = &states;
        store.occupied = [store.is_occupied(Slot::A, a), store.is_occupied(Slot::B, b)];
        let settled = match chosen {
            None => store.undo(&states),
            Some(chosen) => store.settle(chosen, &states, buffer),
        };
        store.settled = !matches!(settled, Settled::Failed(_));
        let source = match chosen {
            None => Source::Nominal(states),
            Some(Chosen { slot, .. }) => match slot.other().of(states) {
                SlotState::Rejected(rejected) => Source::LastGood { slot, rejected },
                _ => Source::Newest(slot),
            },
        };
        let blob = chosen.and_then(|_| Blob::check(buffer).ok());
        Ok((store, Opened { blob, source, settled }))
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

    /// Bytes of the longest blob that fits, if the shortest of this arm does.
    fn longest_blob(&self, buffer: &[u8]) -> Result<usize, GeometryError> {
        let joints = self.accept.joints();
        if joints == 0 || joints > MAX_JOINTS {
            return Err(GeometryError::Joints(joints));
        }
        let (room, got) = (self.room(), buffer.len());
        let needed = self.accept.shortest().next_multiple_of(M::WORD);
        if got < needed {
            return Err(GeometryError::Buffer { needed, got });
        }
        if room < needed {
            return Err(GeometryError::Slot { needed, room });
        }
        Ok(got.min(room) / M::WORD * M::WORD)
    }

    /// Reads a slot into the buffer and judges it.
    fn examine(&mut self, slot: Slot, buffer: &mut [u8]) -> SlotState<M::Error> {
        let bytes = buffer.get_mut(..self.longest).unwrap_or(&mut []);
        if let Err(rejection) = self.read_stable(slot, bytes) {
            return SlotState::Rejected(rejection);
        }
        match self.accept.check(bytes) {
            Ok(blob) => {
                let sequence = blob.sequence();
                let blob = bytes.get(..blob.size()).unwrap_or(bytes);
                let last = last_four(blob);
                match self.marks(slot) {
                    Err(fault) => SlotState::Rejected(Rejection::Fault(fault)),
                    Ok(Some(Marks { progress, copies, last: of })) if Some(of) == last => {
                        SlotState::Valid { sequence, progress, copies }
                    }
                    Ok(_) => SlotState::Valid { sequence, progress: Progress::Done, copies: 0 },
                }
            }
            Err(AcceptanceError::Damaged(DecodeError::NotABlob)) if self.is_blank(slot) => {
                SlotState::Blank
            }
            Err(refusal) => SlotState::Rejected(Rejection::Blob(refusal)),
        }
    }

    fn read_stable(&mut self, slot: Slot, bytes: &mut [u8]) -> Result<(), Rejection<M::Error>> {
        for _ in 0..READINGS {
            self.medium.read(slot, 0, bytes).map_err(Rejection::Fault)?;
            let all = 0..bytes.len();
            if self.compare(slot, bytes, &[all]).map_err(Rejection::Fault)? {
                return Ok(());
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

    /// Whether a slot holds what is not the store's to erase: what it cannot
    /// read, or a whole blob that was refused for another reason than its age.
    fn is_occupied(&mut self, slot: Slot, state: &SlotState<M::Error>) -> bool {
        match state {
            SlotState::Rejected(Rejection::Fault(_)) => true,
            SlotState::Rejected(Rejection::Blob(refusal)) => match refusal {
                AcceptanceError::OldSequence { .. } => false,
                AcceptanceError::Damaged(error) => match error {
                    DecodeError::NotABlob | DecodeError::Checksum { .. } => false,
                    // Judged before the checksum.
                    DecodeError::Truncated { .. }
                    | DecodeError::DraftLayout(_)
                    | DecodeError::NewerLayout(_) => self.is_beyond(slot).unwrap_or(true),
                    _ => true,
                },
                _ => true,
            },
            _ => false,
        }
    }

    /// Whether a slot holds an undamaged blob that is longer than the buffer or
    /// of another layout.
    fn is_beyond(&mut self, slot: Slot) -> Result<bool, Fault<M::Error>> {
        let size = self.medium.slot_size();
        let mut bytes = [0; MAX_WORD];
        let mut frame = None;
        for start in (0..size).step_by(MAX_WORD) {
            let piece = bytes.get_mut(..MAX_WORD.min(size - start)).unwrap_or(&mut []);
            self.medium.read(slot, start, piece)?;
            match frame.get_or_insert_with(|| Frame::begin(piece)) {
                Some(frame) if frame.size() <= size => frame.add(piece),
                _ => return Ok(false),
            }
        }
        // A torn blob may read otherwise now, and as one that would be taken.
        let beyond = |frame: Frame| frame.layout() != LAYOUT || frame.size() > self.longest;
        Ok(frame.flatten().is_some_and(|frame| frame.is_whole() && beyond(frame)))
    }

    /// Ends or undoes what a store left unfinished. The bytes of the chosen blob
    /// are in the buffer.
    fn settle(
        &mut self,
        chosen: Chosen,
        states: &[SlotState<M::Error>; 2],
        buffer: &[u8],
    ) -> Settled<M::Error> {
        let Chosen { slot, sequence, progress, copies } = chosen;
        self.live = Some((slot, sequence));
        if progress == Progress::Done {
            return self.undo(states);
        }
        let fallback = match slot.other().of(states.each_ref()) {
            SlotState::Valid { sequence: older, .. } => *older < sequence,
            // Nothing is left if it is lost, but that was so before its store.
            _ => slot.other().of(self.occupied),
        };
        let (target, copies) = if progress == Progress::Committing && fallback {
            (slot, copies)
        } else {
            // It is solid, or nothing is left if it is lost.
            (slot.other(), copies.saturating_add(1))
        };
        let size = Blob::check(buffer).map_or(0, |blob| blob.size());
        match self.write(target, Mark::Begun { copies }, buffer.get(..size).unwrap_or(&[])) {
            Ok(()) => {
                self.live = Some((target, sequence));
                Settled::Rewritten
            }
            Err(error) => Settled::Failed(error),
        }
    }

    /// Erases what a store began and was cut or damaged before it ended.
    fn undo(&mut self, states: &[SlotState<M::Error>; 2]) -> Settled<M::Error> {
        let mut settled = Settled::Already;
        for slot in [Slot::A, Slot::B] {
            let rejected = matches!(slot.of(states.each_ref()), SlotState::Rejected(_));
            if !rejected || slot.of(self.occupied) {
                continue;
            }
            let begun = |marks: Option<Marks>| {
                marks.is_some_and(|marks| marks.progress == Progress::Committing)
            };
            let undone = match self.marks(slot).map(begun) {
                Ok(true) => self.medium.erase(slot).map(|()| settled = Settled::Erased),
                Ok(false) => Ok(()),
                Err(fault) => Err(fault),
            };
            if let Err(fault) = undone {
                return Settled::Failed(WriteError::Fault(fault));
            }
        }
        settled
    }
}

/// The valid blob that is returned.
#[derive(Clone, Copy)]
struct Chosen {
    slot: Slot,
    sequence: u32,
    progress: Progress,
    copies: u8,
}

/// The slot of the newest valid blob. Of two alike a solid one; of two solid
/// ones the copy, for its original may have been erased since, in part; of two
/// others the original.
fn newest<E>(states: &[SlotState<E>; 2]) -> Option<Slot> {
    let key = |state: &SlotState<E>| match *state {
        SlotState::Valid { sequence, progress: Progress::Committing, copies } => {
            Some((sequence, false, u8::MAX - copies))
        }
        SlotState::Valid { sequence, copies, .. } => Some((sequence, true, copies)),
        _ => None,
    };
    let [a, b] = states.each_ref().map(key);
    match (a, b) {
        (None, None) => None,
        (a, b) if a >= b => Some(Slot::A),
        _ => Some(Slot::B),
    }
}
