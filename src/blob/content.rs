use core::ops::Range;

use super::check::Blob;
use super::layout::{CREATED, ROBOT_ID, SEQUENCE};

impl Blob<'_> {
    /// Where in the bytes the parameters stand: all but the sequence number,
    /// the time of creation, the tag and the checksum. Blobs that are equal
    /// there are the same parameters.
    #[must_use]
    pub fn content(&self) -> [Range<usize>; 3] {
        [0..SEQUENCE.start, ROBOT_ID, CREATED.end..self.signed.len()]
    }
}
