use core::fmt;

/// Longest write word, or EEPROM page, in bytes.
pub const MAX_WORD: usize = 256;

/// One of the two places for a blob.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slot {
    /// The one at the lower address of the shipped `memory.x`.
    A,
    /// The other one.
    B,
}

impl Slot {
    /// The one that this is not.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }

    /// The one of two things that belongs to this slot.
    pub(super) fn of<T: Copy>(self, [a, b]: [T; 2]) -> T {
        match self {
            Self::A => a,
            Self::B => b,
        }
    }

    /// Gives this slot another of two things.
    pub(super) fn replace<T>(self, [a, b]: &mut [T; 2], value: T) {
        *(match self {
            Self::A => a,
            Self::B => b,
        }) = value;
    }
}

impl fmt::Display for Slot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str((*self).of(["A", "B"]))
    }
}

/// What the store wants of a memory. Offsets count from the start of a slot.
pub trait Medium {
    /// Bytes that one program operation writes, a power of two up to
    /// [`MAX_WORD`]: the write granularity of a flash, the page of an EEPROM.
    /// A cut operation may spoil all bytes of its word, and no other.
    const WORD: usize;

    /// Bytes of a slot, whole words.
    fn slot_size(&self) -> usize;

    /// Reads whole words.
    ///
    /// # Errors
    /// When the device does not answer.
    fn read(&mut self, slot: Slot, offset: usize, bytes: &mut [u8]) -> Result<(), Fault>;

    /// Sets every byte of a slot to 0xff.
    ///
    /// # Errors
    /// When the device does not answer or cannot erase.
    fn erase(&mut self, slot: Slot) -> Result<(), Fault>;

    /// Writes whole words that have been erased and not written since, in
    /// ascending order.
    ///
    /// # Errors
    /// When the device does not answer or cannot write.
    fn program(&mut self, slot: Slot, offset: usize, bytes: &[u8]) -> Result<(), Fault>;
}

/// What a memory was doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Operation {
    /// Reading.
    Read,
    /// Erasing.
    Erase,
    /// Programming.
    Program,
}

/// What went wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FaultKind {
    /// An address that the device's granularity forbids.
    NotAligned,
    /// An address beyond the device.
    OutOfBounds,
    /// The device refused or did not answer.
    Device,
}

/// A memory that did not do what it should.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fault {
    /// What it was doing.
    pub during: Operation,
    /// What went wrong.
    pub kind: FaultKind,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let operation = match self.during {
            Operation::Read => "reading",
            Operation::Erase => "erasing",
            Operation::Program => "programming",
        };
        let kind = match self.kind {
            FaultKind::NotAligned => "the address is not aligned",
            FaultKind::OutOfBounds => "the address is beyond the device",
            FaultKind::Device => "the device failed",
        };
        write!(f, "{operation}: {kind}")
    }
}

impl core::error::Error for Fault {}

/// Slots that do not fit their device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum GeometryError {
    /// The write word is not a power of two up to [`MAX_WORD`], or the device
    /// reads coarser than it writes.
    Word {
        /// Bytes of a write word.
        word: usize,
    },
    /// A slot does not begin and end on a boundary of the device: erase block
    /// of a flash, page of an EEPROM.
    Boundary {
        /// Bytes between boundaries.
        every: usize,
    },
    /// The slots overlap.
    Overlap,
    /// A slot ends beyond the device.
    Capacity {
        /// Bytes of the device.
        capacity: usize,
    },
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Word { word } => {
                write!(f, "a write word of {word} bytes, which must be a power of two up to 256")
            }
            Self::Boundary { every } => {
                write!(f, "slots must begin and end at multiples of {every} bytes")
            }
            Self::Overlap => f.write_str("the two slots overlap"),
            Self::Capacity { capacity } => {
                write!(f, "a slot ends beyond the device's {capacity} bytes")
            }
        }
    }
}

impl core::error::Error for GeometryError {}

/// Where two slots of one size lie in a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Geometry {
    starts: [u32; 2],
    size: u32,
}

impl Geometry {
    pub fn new(
        starts: [u32; 2],
        size: u32,
        word: usize,
        boundary: usize,
        capacity: usize,
    ) -> Result<Self, GeometryError> {
        if !word.is_power_of_two() || word > MAX_WORD {
            return Err(GeometryError::Word { word });
        }
        let [a, b] = starts;
        let aligned = |value: u32| (value as usize).is_multiple_of(boundary);
        if !(aligned(a) && aligned(b) && aligned(size) && boundary.is_multiple_of(word)) {
            return Err(GeometryError::Boundary { every: boundary });
        }
        if a.abs_diff(b) < size {
            return Err(GeometryError::Overlap);
        }
        match a.max(b).checked_add(size) {
            Some(end) if end as usize <= capacity => Ok(Self { starts, size }),
            _ => Err(GeometryError::Capacity { capacity }),
        }
    }

    pub fn size(&self) -> usize {
        self.size as usize
    }

    /// First byte of a slot in the device, and the one after its last.
    pub fn range(&self, slot: Slot) -> (u32, u32) {
        let start = slot.of(self.starts);
        (start, start.wrapping_add(self.size))
    }

    /// Address of `len` bytes at an offset in a slot, if they lie in it.
    pub fn address(
        &self,
        slot: Slot,
        offset: usize,
        len: usize,
        during: Operation,
    ) -> Result<u32, Fault> {
        let inside = offset.checked_add(len).is_some_and(|end| end <= self.size());
        // A slot is no longer than a u32 says.
        match (inside, u32::try_from(offset)) {
            (true, Ok(offset)) => Ok(slot.of(self.starts).wrapping_add(offset)),
            _ => Err(Fault { during, kind: FaultKind::OutOfBounds }),
        }
    }
}
