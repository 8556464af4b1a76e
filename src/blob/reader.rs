/// Reads fixed-size pieces from the front; `None` past the end.
pub(super) struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn take<const K: usize>(&mut self) -> Option<&'a [u8; K]> {
        let (front, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(front)
    }
    pub fn slice(&mut self, size: usize) -> Option<&'a [u8]> {
        let (front, rest) = self.0.split_at_checked(size)?;
        self.0 = rest;
        Some(front)
    }
    pub fn f32(&mut self) -> f32 {
        // Only called on slices whose length was checked; NaN is refused by
        // every field check, so a wrong length cannot pass unnoticed.
        self.take().map_or(f32::NAN, |b| f32::from_le_bytes(*b))
    }
}
