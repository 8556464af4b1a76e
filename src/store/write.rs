use core::ops::Range;

use super::medium::{Fault, MAX_WORD, Medium, Slot};
use super::open::Store;
use super::report::{Progress, StoreError, Stored, WriteError};
use crate::blob::Blob;

/// Bytes of a mark at the end of a slot.
const MARK: usize = 8;

/// So many programmed bits of `DONE` prove that writing it has begun, and so that
/// the commit word was finished. Not a single one: a blank word that was hardly
/// touched may read so once.
const BEGUN_BITS: u32 = 4;

/// So many wrong bits of `DONE` are no reason to write: a cut may leave a few
/// that read differently from time to time, and cells may age. A `DONE` that is
/// this close to whole never reads with less than [`BEGUN_BITS`] later.
const WRONG_BITS: u32 = 2;

/// What the store writes at the end of a slot, in the order of writing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    /// With the number of times that the blob went to the other slot.
    Begun {
        copies: u8,
    },
    Done,
}

impl Mark {
    const fn tag(self) -> [u8; 4] {
        match self {
            Self::Begun { copies: 0 } => *b"BEGN",
            Self::Begun { copies } => [b'C', b'P', b'Y', copies],
            Self::Done => *b"DONE",
        }
    }

    /// It ends with the blob's last bytes, so that none of an earlier blob can
    /// stand for it.
    fn of(self, bytes: &[u8]) -> [u8; MARK] {
        let [a, b, c, d] = self.tag();
        let [e, f, g, h] = last_four(bytes).unwrap_or_default();
        [a, b, c, d, e, f, g, h]
    }
}

/// What stands in the marks of a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Marks {
    pub progress: Progress,
    pub copies: u8,
    /// Last bytes of the blob that they belong to.
    pub last: [u8; 4],
}

impl<M: Medium> Store<M> {
    /// Stores a blob in the slot that is not in use: erases it, writes the
    /// payload, reads it back, commits.
    ///
    /// # Errors
    /// When the blob is invalid, not accepted, not newer or too long, or the
    /// slot holds what is not the store's to erase, nothing has been written.
    /// See [`StoreError`].
    pub fn store(&mut self, bytes: &[u8]) -> Result<Stored, StoreError<M::Error>> {
        let blob = self.accept.check(bytes)?;
        if !self.settled {
            return Err(StoreError::Unsettled);
        }
        if let Some((slot, stored)) = self.live {
            if self.holds(slot, bytes, &blob).map_err(WriteError::Fault)? {
                return Ok(Stored::Unchanged);
            }
            let offered = blob.sequence();
            if offered <= stored {
                return Err(StoreError::NotNewer { stored, offered });
            }
        }
        let target = match self.live {
            Some((slot, _)) => slot.other(),
            None if Slot::A.of(self.occupied) => Slot::B,
            None => Slot::A,
        };
        let bytes = bytes.get(..blob.size()).unwrap_or(bytes);
        self.write(target, Mark::Begun { copies: 0 }, bytes)?;
        self.live = Some((target, blob.sequence()));
        Ok(Stored::Written(target))
    }

    /// Erases a slot that is not in use, whatever it holds: another robot's
    /// blob, one of a newer layout, one that was longer than the buffer. The
    /// store never does so by itself. Where it was [`Settled::Failed`] for that
    /// slot, open it again then.
    ///
    /// [`Settled::Failed`]: super::Settled::Failed
    ///
    /// # Errors
    /// [`StoreError::InUse`], and faults of the memory.
    pub fn discard(&mut self, slot: Slot) -> Result<(), StoreError<M::Error>> {
        if self.live.is_some_and(|(live, _)| live == slot) {
            return Err(StoreError::InUse(slot));
        }
        self.medium.erase(slot).map_err(WriteError::Fault)?;
        slot.replace(&mut self.occupied, false);
        Ok(())
    }

    fn fits(&self, needed: usize) -> Result<(), WriteError<M::Error>> {
        let room = self.longest;
        if needed > room { Err(WriteError::TooLong { needed, room }) } else { Ok(()) }
    }

    /// Whether a slot has the contents of this blob.
    fn holds(&mut self, slot: Slot, bytes: &[u8], blob: &Blob) -> Result<bool, Fault<M::Error>> {
        let bytes = bytes.get(..blob.size()).unwrap_or(bytes);
        self.compare(slot, bytes, &blob.content())
    }

    /// Writes a blob, of which nothing counts until the first word is written.
    pub(super) fn write(
        &mut self,
        slot: Slot,
        begin: Mark,
        bytes: &[u8],
    ) -> Result<(), WriteError<M::Error>> {
        self.fits(bytes.len())?;
        if slot.of(self.occupied) {
            return Err(WriteError::Occupied(slot));
        }
        self.medium.erase(slot)?;
        self.write_mark(slot, begin, bytes)?;
        self.program(slot, bytes, M::WORD)?;
        self.verify(slot, bytes, M::WORD)?;
        let (first, _) = bytes.split_at_checked(M::WORD).unwrap_or((bytes, &[]));
        self.program(slot, first, 0)?;
        self.verify(slot, first, 0)?;
        self.write_mark(slot, Mark::Done, bytes)
    }

    /// What the marks of a slot say; `None` where no store has begun.
    pub(super) fn marks(&mut self, slot: Slot) -> Result<Option<Marks>, Fault<M::Error>> {
        let begun = self.read_mark(slot, Self::BEGUN)?;
        let [a, b, c, d, last @ ..] = begun;
        let copies = match [a, b, c, d] {
            [b'B', b'E', b'G', b'N'] => 0,
            [b'C', b'P', b'Y', copies] => copies,
            _ => return Ok(None),
        };
        let done = self.read_mark(slot, Self::DONE)?;
        let [done, right] = [done, Mark::Done.of(&begun)].map(u64::from_le_bytes);
        let (programmed, wrong) = (done.count_zeros(), (done ^ right).count_ones());
        let progress = match (wrong, programmed) {
            (..=WRONG_BITS, _) => Progress::Done,
            (_, BEGUN_BITS..) => Progress::Ending,
            _ => Progress::Committing,
        };
        Ok(Some(Marks { progress, copies, last }))
    }

    fn write_mark(
        &mut self,
        slot: Slot,
        mark: Mark,
        bytes: &[u8],
    ) -> Result<(), WriteError<M::Error>> {
        let place = if mark == Mark::Done { Self::DONE } else { Self::BEGUN };
        let offset = self.room() + place;
        let mut padded = [0xff; MAX_WORD];
        padded.iter_mut().zip(mark.of(bytes)).for_each(|(to, byte)| *to = byte);
        let word = padded.get(..Self::MARK_WORD).unwrap_or(&[]);
        self.medium.program(slot, offset, word)?;
        if self.read_mark(slot, place)? == mark.of(bytes) {
            Ok(())
        } else {
            Err(WriteError::ReadBack(slot))
        }
    }

    fn read_mark(&mut self, slot: Slot, place: usize) -> Result<[u8; MARK], Fault<M::Error>> {
        let offset = self.room() + place;
        let mut padded = [0; MAX_WORD];
        let word = padded.get_mut(..Self::MARK_WORD).unwrap_or(&mut []);
        self.medium.read(slot, offset, word)?;
        Ok(word.first_chunk().copied().unwrap_or_default())
    }

    /// Places of the marks, behind the room for a blob.
    const BEGUN: usize = 0;
    const DONE: usize = Self::MARK_WORD;
    const MARK_WORD: usize = if M::WORD > MARK { M::WORD } else { MARK };

    /// Bytes of a slot before its marks.
    pub(super) fn room(&self) -> usize {
        self.medium.slot_size().saturating_sub(2 * Self::MARK_WORD)
    }

    /// Programs the bytes from `from` on, less than [`MAX_WORD`]; the last word
    /// is filled up with 0xff.
    fn program(&mut self, slot: Slot, bytes: &[u8], from: usize) -> Result<(), Fault<M::Error>> {
        let mut skip = from;
        for (piece, start) in pieces(bytes) {
            let mut padded = [0xff; MAX_WORD];
            padded.iter_mut().zip(piece).for_each(|(to, byte)| *to = *byte);
            let words = padded.get(skip..piece.len().next_multiple_of(M::WORD)).unwrap_or(&[]);
            if !words.is_empty() {
                self.medium.program(slot, start + skip, words)?;
            }
            skip = 0;
        }
        Ok(())
    }

    fn verify(
        &mut self,
        slot: Slot,
        bytes: &[u8],
        from: usize,
    ) -> Result<(), WriteError<M::Error>> {
        let equal = self.compare(slot, bytes, core::slice::from_ref(&(from..bytes.len())))?;
        if equal { Ok(()) } else { Err(WriteError::ReadBack(slot)) }
    }

    /// Whether a slot begins with these bytes, those in one of the ranges.
    #[inline(never)]
    pub(super) fn compare(
        &mut self,
        slot: Slot,
        bytes: &[u8],
        counts: &[Range<usize>],
    ) -> Result<bool, Fault<M::Error>> {
        for (piece, start) in pieces(bytes) {
            let mut read = [0; MAX_WORD];
            let words = read.get_mut(..piece.len().next_multiple_of(M::WORD)).unwrap_or(&mut []);
            self.medium.read(slot, start, words)?;
            let mut pairs = words.iter().zip(piece).zip(start..);
            if !pairs.all(|((read, byte), offset)| {
                read == byte || !counts.iter().any(|range| range.contains(&offset))
            }) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Pieces of [`MAX_WORD`] bytes, the last one shorter, each with its offset. By
/// hand, as slices' own `chunks` can panic where it is built for size.
fn pieces(bytes: &[u8]) -> impl Iterator<Item = (&[u8], usize)> {
    let mut start = 0;
    core::iter::from_fn(move || {
        let (rest, offset) = (bytes.get(start..).filter(|rest| !rest.is_empty())?, start);
        start += MAX_WORD;
        Some((rest.get(..MAX_WORD).unwrap_or(rest), offset))
    })
}

/// The end of a blob, which stands in its marks.
pub(super) fn last_four(bytes: &[u8]) -> Option<[u8; 4]> {
    bytes.get(bytes.len().checked_sub(4)?..)?.first_chunk().copied()
}
