use core::fmt;

use crate::arm::MAX_JOINTS;

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
    pub(super) fn of<T>(self, [a, b]: [T; 2]) -> T {
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
    /// What its driver says when it fails.
    type Error: fmt::Debug;

    /// Bytes that one program operation writes, a power of two up to
    /// [`MAX_WORD`]: the write granularity of a flash, the page of an EEPROM.
    /// A cut operation may spoil all bytes of its word, and no other. Another
    /// number does not compile.
    const WORD: usize;

    /// Bytes of a slot, whole words.
    fn slot_size(&self) -> usize;

    /// Reads whole words.
    ///
    /// # Errors
    /// When the device does not answer.
    fn read(
        &mut self,
        slot: Slot,
        offset: usize,
        bytes: &mut [u8],
    ) -> Result<(), Fault<Self::Error>>;

    /// Sets every byte of a slot to 0xff.
    ///
    /// # Errors
    /// When the device does not answer or cannot erase.
    fn erase(&mut self, slot: Slot) -> Result<(), Fault<Self::Error>>;

    /// Writes whole words that have been erased and not written since, in
    /// ascending order.
    ///
    /// # Errors
    /// When the device does not answer or cannot write.
    fn program(
        &mut self,
        slot: Slot,
        offset: usize,
        bytes: &[u8],
    ) -> Result<(), Fault<Self::Error>>;
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
pub enum FaultKind<E> {
    /// An address beyond the slot.
    OutOfBounds,
    /// What the driver says.
    Driver(E),
}

/// A memory that did not do what it should.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fault<E> {
    /// What it was doing.
    pub during: Operation,
    /// What went wrong.
    pub kind: FaultKind<E>,
}

impl<E> Fault<E> {
    /// For `map_err`: this is what the driver says.
    pub(super) fn of(during: Operation) -> impl Fn(E) -> Self {
        move |error| Self { during, kind: FaultKind::Driver(error) }
    }
}

impl<E: fmt::Debug> fmt::Display for Fault<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let operation = match self.during {
            Operation::Read => "reading",
            Operation::Erase => "erasing",
            Operation::Program => "programming",
        };
        match &self.kind {
            FaultKind::OutOfBounds => write!(f, "{operation}: the address is beyond the slot"),
            FaultKind::Driver(error) => write!(f, "{operation}: the driver says {error:?}"),
        }
    }
}

// Drivers' errors are Debug and often no more: none is a `source`.
impl<E: fmt::Debug> core::error::Error for Fault<E> {}

/// Slots that do not fit their device, or a store that cannot serve its arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum GeometryError {
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
    /// No arm has so many joints.
    Joints(usize),
    /// The buffer cannot hold even the shortest blob of the arm.
    Buffer {
        /// Bytes of that blob in whole write words.
        needed: usize,
        /// Bytes given.
        got: usize,
    },
    /// A slot cannot, with its marks.
    Slot {
        /// Bytes of that blob.
        needed: usize,
        /// Bytes a slot has for it.
        room: usize,
    },
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boundary { every } => {
                write!(f, "slots must begin and end at multiples of {every} bytes")
            }
            Self::Overlap => f.write_str("the two slots overlap"),
            Self::Capacity { capacity } => {
                write!(f, "a slot ends beyond the device's {capacity} bytes")
            }
            Self::Joints(joints) => {
                write!(f, "{joints} joints where 1 to {MAX_JOINTS} are possible")
            }
            Self::Buffer { needed, got } => {
                write!(f, "a buffer of {got} bytes where a blob of this arm has {needed} or more")
            }
            Self::Slot { needed, room } => write!(
                f,
                "a slot has room for {room} bytes, a blob of this arm has {needed} or more"
            ),
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

/// Whether a write word can be one, see [`Medium::WORD`].
pub(super) const fn is_word(word: usize) -> bool {
    word.is_power_of_two() && word <= MAX_WORD
}

impl Geometry {
    pub fn new(
        starts: [u32; 2],
        size: u32,
        boundary: usize,
        capacity: usize,
    ) -> Result<Self, GeometryError> {
        let [a, b] = starts;
        let aligned = |value: u32| (value as usize).is_multiple_of(boundary);
        if !(aligned(a) && aligned(b) && aligned(size)) {
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
    pub fn address<E>(
        &self,
        slot: Slot,
        offset: usize,
        len: usize,
        during: Operation,
    ) -> Result<u32, Fault<E>> {
        let inside = offset.checked_add(len).is_some_and(|end| end <= self.size());
        // A slot is no longer than a u32 says.
        match (inside, u32::try_from(offset)) {
            (true, Ok(offset)) => Ok(slot.of(self.starts).wrapping_add(offset)),
            _ => Err(Fault { during, kind: FaultKind::OutOfBounds }),
        }
    }
}
