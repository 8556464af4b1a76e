//! What the store writes at the end of a slot.

use super::report::Progress;

/// Bytes of a mark at the end of a slot.
pub(super) const MARK: usize = 8;

/// So many programmed bits of `DONE` prove that writing it has begun, and so that
/// the commit word was finished. Not a single one: a blank word that was hardly
/// touched may read so once.
pub(super) const BEGUN_BITS: u32 = 4;

/// So many wrong bits of `DONE` are no reason to write: a cut may leave a few
/// that read differently from time to time, and cells may age. A `DONE` that is
/// this close to whole never reads with less than [`BEGUN_BITS`] later.
pub(super) const WRONG_BITS: u32 = 2;

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
    pub fn of(self, bytes: &[u8]) -> [u8; MARK] {
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

/// The end of a blob, which stands in its marks.
pub(super) fn last_four(bytes: &[u8]) -> Option<[u8; 4]> {
    bytes.get(bytes.len().checked_sub(4)?..)?.first_chunk().copied()
}
