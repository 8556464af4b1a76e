//! What is written into a slot and read from it.

use core::ops::Range;

use super::marks::{BEGUN_BITS, MARK, Mark, Marks, WRONG_BITS, programmed_bits, wrong_bits};
use super::medium::{Fault, MAX_WORD, Medium, Slot};
use super::report::{Progress, WriteError};
use crate::blob::Acceptance;

/// How often a slot is read until two readings agree, and a word that fails.
pub(super) const READINGS: usize = 8;

/// Two slots, of which one may be in use.
#[derive(Debug)]
pub struct Store<M> {
    pub(super) medium: M,
    pub(super) accept: Acceptance,
    /// Bytes of the longest blob that the slots and the buffer of `open` take.
    pub(super) longest: usize,
    /// The slot whose blob `open` returned or `store` wrote; its sequence.
    pub(super) live: Option<(Slot, u32)>,
    /// Whether the slots may be erased.
    pub(super) held: [Held; 2],
    /// Whether what `open` returned will last, if anything.
    pub(super) settled: bool,
}

/// Whether what a slot holds is the store's to erase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Held {
    Free,
    /// A whole blob that was refused.
    Foreign,
    /// What could not be read: only if it is torn.
    Unread,
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
        self.clear(slot)?;
        self.write_mark(slot, begin, bytes)?;
        self.program(slot, bytes, M::WORD)?;
        self.verify(slot, bytes, M::WORD)?;
        let (first, _) = bytes.split_at_checked(M::WORD).unwrap_or((bytes, &[]));
        self.program(slot, first, 0)?;
        self.verify(slot, first, 0)?;
        self.write_mark(slot, Mark::Done, bytes)
    }

    /// Erases a slot, unless it holds what is not the store's to erase.
    #[inline(never)]
    pub(super) fn clear(&mut self, slot: Slot) -> Result<(), WriteError<M::Error>> {
        let free = match slot.of(self.held) {
            Held::Free => true,
            Held::Foreign => false,
            Held::Unread => self.is_torn(slot),
        };
        if !free {
            return Err(WriteError::Occupied(slot));
        }
        self.medium.erase(slot)?;
        slot.replace(&mut self.held, Held::Free);
        Ok(())
    }

    fn fits(&self, needed: usize) -> Result<(), WriteError<M::Error>> {
        let room = self.longest;
        if needed > room { Err(WriteError::TooLong { needed, room }) } else { Ok(()) }
    }

    /// What the marks of a slot say; `None` where no store has begun.
    pub(super) fn marks(&mut self, slot: Slot) -> Result<Option<Marks>, Fault<M::Error>> {
        let Some(begun) = self.read_mark(slot, Self::BEGUN)? else {
            // A store was cut here, or an erase.
            return Ok(Some(Marks { progress: Progress::Committing, copies: 0, last: None }));
        };
        let [a, b, c, d, last @ ..] = begun;
        let copies = match [a, b, c, d] {
            [b'B', b'E', b'G', b'N'] => 0,
            [b'C', b'P', b'Y', copies] => copies,
            _ => return Ok(None),
        };
        let progress = match self.read_mark(slot, Self::DONE)? {
            Some(done) => match (wrong_bits(done, Mark::Done.of(&begun)), programmed_bits(done)) {
                (..=WRONG_BITS, _) => Progress::Done,
                (_, BEGUN_BITS..) => Progress::Ending,
                _ => Progress::Committing,
            },
            // What cannot be read is not blank.
            None => Progress::Ending,
        };
        Ok(Some(Marks { progress, copies, last: Some(last) }))
    }

    #[inline(never)]
    fn write_mark(
        &mut self,
        slot: Slot,
        mark: Mark,
        bytes: &[u8],
    ) -> Result<(), WriteError<M::Error>> {
        // As much as the next `open` takes for the same.
        let (place, tolerated) =
            if mark == Mark::Done { (Self::DONE, WRONG_BITS) } else { (Self::BEGUN, 0) };
        let offset = self.room() + place;
        let mut padded = [0xff; MAX_WORD];
        padded.iter_mut().zip(mark.of(bytes)).for_each(|(to, byte)| *to = byte);
        let word = padded.get(..Self::MARK_WORD).unwrap_or(&[]);
        self.medium.program(slot, offset, word)?;
        match self.read_mark(slot, place)? {
            Some(read) if wrong_bits(read, mark.of(bytes)) <= tolerated => Ok(()),
            _ => Err(WriteError::ReadBack(slot)),
        }
    }

    /// `None` where it is torn: it fails at every reading, while others of the
    /// slot do not.
    #[inline(never)]
    fn read_mark(
        &mut self,
        slot: Slot,
        place: usize,
    ) -> Result<Option<[u8; MARK]>, Fault<M::Error>> {
        let offset = self.room() + place;
        let mut padded = [0; MAX_WORD];
        let word = padded.get_mut(..Self::MARK_WORD).unwrap_or(&mut []);
        for _ in 0..READINGS {
            match self.medium.read(slot, offset, word) {
                Ok(()) => return Ok(word.first_chunk().copied()),
                Err(fault) if self.sound(slot).is_none() => return Err(fault),
                Err(_) => (),
            }
        }
        Ok(None)
    }

    /// Whether a word of a slot fails, or reads otherwise, at every two readings,
    /// while after these another one of the slot is read, or where there is none
    /// the first of the slot in use: a device that does not answer is no torn word.
    fn is_torn(&mut self, slot: Slot) -> bool {
        let all = 0..self.medium.slot_size();
        let Some(torn) = all.step_by(M::WORD).find(|at| !self.reads(slot, *at)) else {
            return false;
        };
        let own = self.sound(slot).map(|at| (slot, at));
        let Some((other, sound)) = own.or(self.live.map(|(live, _)| (live, 0))) else {
            return false;
        };
        (0..READINGS).all(|_| !self.reads(slot, torn) && self.reads(other, sound))
    }

    /// The first word of a slot that can be read.
    #[inline(never)]
    fn sound(&mut self, slot: Slot) -> Option<usize> {
        (0..self.medium.slot_size()).step_by(M::WORD).find(|at| self.reads(slot, *at))
    }

    /// Whether a word can be read, and reads the same again.
    #[inline(never)]
    fn reads(&mut self, slot: Slot, offset: usize) -> bool {
        let mut words = [[0; MAX_WORD]; 2];
        let [a, b] = &mut words;
        [a, b].into_iter().all(|word| {
            self.medium.read(slot, offset, word.get_mut(..M::WORD).unwrap_or(&mut [])).is_ok()
        }) && {
            let [a, b] = &words;
            a.get(..M::WORD) == b.get(..M::WORD)
        }
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
