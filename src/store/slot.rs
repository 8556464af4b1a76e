//! What is written into a slot and read from it.

use core::ops::Range;

use super::marks::{BEGUN_BITS, MARK, Mark, Marks, WRONG_BITS};
use super::medium::{Fault, MAX_WORD, Medium, Slot};
use super::report::{Progress, WriteError};
use crate::blob::Acceptance;

/// Two slots, of which one may be in use.
#[derive(Debug)]
pub struct Store<M> {
    pub(super) medium: M,
    pub(super) accept: Acceptance,
    /// Bytes of the longest blob that the slots and the buffer of `open` take.
    pub(super) longest: usize,
    /// The slot whose blob `open` returned or `store` wrote; its sequence.
    pub(super) live: Option<(Slot, u32)>,
    /// Slots that hold what is not the store's to erase.
    pub(super) occupied: [bool; 2],
    /// Whether what `open` returned will last.
    pub(super) settled: bool,
}

impl<M: Medium> Store<M> {
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

    fn fits(&self, needed: usize) -> Result<(), WriteError<M::Error>> {
        let room = self.longest;
        if needed > room { Err(WriteError::TooLong { needed, room }) } else { Ok(()) }
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
