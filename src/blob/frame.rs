use super::crc32c::Crc32c;
use super::layout::{CHECKSUM, LENGTH, MAGIC};

/// What blobs of all layouts have in common, older and newer ones: the magic
/// first, layout and length behind it, a checksum of all bytes before it last. It
/// tells a whole blob that this version refuses from a damaged one, in pieces
/// and without memory for it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    layout: u16,
    size: usize,
    seen: usize,
    crc: Crc32c,
}

impl Frame {
    /// Of what begins with these bytes.
    pub fn begin(bytes: &[u8]) -> Option<Self> {
        let length = bytes.get(LENGTH)?.first_chunk()?;
        let size = u32::from_le_bytes(*length) as usize;
        let layout = u16::from_le_bytes(*bytes.get(MAGIC.len()..)?.first_chunk()?);
        let begins = bytes.starts_with(&MAGIC) && size >= LENGTH.end + CHECKSUM;
        begins.then_some(Self { layout, size, seen: 0, crc: Crc32c::new() })
    }

    pub fn layout(&self) -> u16 {
        self.layout
    }

    /// Bytes of the blob.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Takes its bytes one piece after the other, from the first on; those
    /// behind its end do not count.
    pub fn add(&mut self, bytes: &[u8]) {
        let rest = self.size.saturating_sub(self.seen);
        let bytes = bytes.get(..rest).unwrap_or(bytes);
        self.crc.update(bytes);
        self.seen = self.seen.saturating_add(bytes.len());
    }

    /// Whether all its bytes came, undamaged.
    pub fn is_whole(&self) -> bool {
        self.seen == self.size && self.crc.value() == Crc32c::RESIDUE
    }
}
