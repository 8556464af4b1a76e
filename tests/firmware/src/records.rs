//! A file of records that xtask writes and an image reads: each a blob of an arm and what
//! belongs to it. Little-endian.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | 4 bytes | which file it is |
//! | 4 | u32 | records |
//! | 8 | u32 | bytes of a blob |
//! | 12 | u32 | 0 |
//! | 16 | u64 | hash of the results that the host computed |
//! | 24 | records | each: the blob, as many bytes as the file's kind has |

#![allow(dead_code, reason = "each of its users needs a part")]

use truearm::blob::Blob;
use truearm::{ArmParameters, Scalar};

/// Bytes before the first record.
pub const HEADER: usize = 24;

/// A file in place.
#[derive(Debug, Clone, Copy)]
pub struct Records<'a> {
    /// Hash that the results must give.
    pub expected: u64,
    blob: usize,
    size: usize,
    bytes: &'a [u8],
}

/// The beginning of a file of so many records with blobs of so many bytes.
pub fn header(magic: [u8; 4], records: usize, blob: usize, expected: u64) -> [u8; HEADER] {
    let words = [u32::from_le_bytes(magic), records as u32, blob as u32, 0];
    let expected = expected.to_le_bytes();
    let bytes = words.iter().flat_map(|word| word.to_le_bytes()).chain(expected);
    let mut header = [0; HEADER];
    header.iter_mut().zip(bytes).for_each(|(to, from)| *to = from);
    header
}

impl<'a> Records<'a> {
    /// Finds the records, which have so many bytes behind their blob, in the front of
    /// `bytes`; `None` if they are not whole.
    pub fn parse(bytes: &'a [u8], magic: [u8; 4], behind: usize) -> Option<Self> {
        let (header, rest) = bytes.split_first_chunk::<HEADER>()?;
        let word = |index: usize| {
            let bytes = header.as_chunks::<4>().0.get(index).copied().unwrap_or_default();
            u32::from_le_bytes(bytes)
        };
        if word(0).to_le_bytes() != magic {
            return None;
        }
        let (records, blob) = (word(1) as usize, word(2) as usize);
        let expected = u64::from(word(5)) << 32 | u64::from(word(4));
        let size = blob.checked_add(behind)?;
        Some(Self { expected, blob, size, bytes: rest.get(..records.checked_mul(size)?)? })
    }

    /// Parameters of the arm and what is behind them; `None` for a blob that is refused.
    pub fn iter<T: Scalar, const N: usize>(
        &self,
    ) -> impl Iterator<Item = Option<(ArmParameters<'a, T, N>, &'a [u8])>> + use<'a, T, N> {
        let blob = self.blob;
        self.bytes.chunks_exact(self.size).map(move |bytes| {
            let (blob, behind) = bytes.split_at_checked(blob)?;
            Some((Blob::check(blob).ok()?.parameters().ok()?, behind))
        })
    }
}

/// The `index`th group of N numbers in these bytes; zeros where there are fewer.
pub fn numbers<const N: usize>(bytes: &[u8], index: usize) -> [f32; N] {
    let mut numbers = [0.0; N];
    let bytes = bytes.chunks_exact(4 * N).nth(index).unwrap_or_default();
    for (number, bytes) in numbers.iter_mut().zip(bytes.as_chunks::<4>().0) {
        *number = f32::from_le_bytes(*bytes);
    }
    numbers
}
