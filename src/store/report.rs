use core::fmt;

use super::medium::{Fault, Slot};
use crate::blob::{AcceptanceError, Blob};

/// What [`super::Store::open`] found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Opened<'b, E> {
    /// The parameters to use; `None`: the nominal ones.
    pub blob: Option<Blob<'b>>,
    /// Where they come from, and why not from elsewhere.
    pub source: Source<E>,
    /// What was done to make it last.
    pub settled: Settled<E>,
}

/// Where the parameters come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Source<E> {
    /// From this slot; the other one is blank or valid and not newer.
    Newest(Slot),
    /// From this slot, because what the other one holds was rejected.
    LastGood {
        /// Where the parameters come from.
        slot: Slot,
        /// Why the other slot was rejected.
        rejected: Rejection<E>,
    },
    /// Neither slot holds parameters for this robot: A, then B.
    Nominal([SlotState<E>; 2]),
}

/// What a slot holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SlotState<E> {
    /// Nothing: every byte is 0xff.
    Blank,
    /// A valid blob for this robot.
    Valid {
        /// Its sequence number.
        sequence: u32,
        /// How far its store got.
        progress: Progress,
        /// How often it went from slot to slot since it was stored.
        copies: u8,
    },
    /// Something that cannot be used.
    Rejected(Rejection<E>),
}

/// How far the store of a valid blob got.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Progress {
    /// Its commit may be torn.
    Committing,
    /// Its commit is solid, the mark that says so is torn.
    Ending,
    /// It ended, or a programmer wrote it.
    Done,
}

/// Why the contents of a slot were rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Rejection<E> {
    /// It could not be read.
    Fault(Fault<E>),
    /// It reads differently every time.
    Unstable,
    /// It is no valid blob, longer than the buffer, not this robot's or not
    /// authentic.
    Blob(AcceptanceError),
}

impl<E: fmt::Debug> fmt::Display for Rejection<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fault(fault) => fault.fmt(f),
            Self::Unstable => f.write_str("reads differently every time"),
            Self::Blob(error) => error.fmt(f),
        }
    }
}

impl<E: fmt::Debug + 'static> core::error::Error for Rejection<E> {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Fault(fault) => Some(fault),
            Self::Unstable => None,
            Self::Blob(error) => Some(error),
        }
    }
}

/// What [`super::Store::open`] did so that the blob it returns lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Settled<E> {
    /// Nothing was needed.
    Already,
    /// The blob's store had not ended: it was written anew, to its own slot or
    /// to the other one.
    Rewritten,
    /// A store that had not ended was undone: its slot was erased.
    Erased,
    /// One of these was needed and failed. The blob can be used, but may be
    /// gone at the next power-up, and [`super::Store::store`] refuses.
    Failed(WriteError<E>),
}

/// A slot that could not be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum WriteError<E> {
    /// The memory failed.
    Fault(Fault<E>),
    /// The slot does not read back as written.
    ReadBack(Slot),
    /// The blob does not fit, and [`super::Store::open`] could not read it back.
    TooLong {
        /// Bytes of the blob.
        needed: usize,
        /// Bytes that a slot has for it, or the buffer given to `open`, in whole
        /// write words, where that is less.
        room: usize,
    },
    /// The slot that is needed holds what is not the store's to erase: see
    /// [`super::Store::discard`].
    Occupied(Slot),
}

impl<E: fmt::Debug> fmt::Display for WriteError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fault(fault) => fault.fmt(f),
            Self::ReadBack(slot) => write!(f, "slot {slot} does not read back as written"),
            Self::TooLong { needed, room } => {
                write!(f, "the blob has {needed} bytes, slot and buffer have room for {room}")
            }
            Self::Occupied(slot) => {
                write!(f, "slot {slot} holds what is not the store's to erase")
            }
        }
    }
}

impl<E: fmt::Debug + 'static> core::error::Error for WriteError<E> {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Fault(fault) => Some(fault),
            _ => None,
        }
    }
}

impl<E> From<Fault<E>> for WriteError<E> {
    fn from(fault: Fault<E>) -> Self {
        Self::Fault(fault)
    }
}

/// What [`super::Store::store`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "nothing may have been written"]
pub enum Stored {
    /// These parameters are in force already, under the same number or a later
    /// one; nothing was written.
    Unchanged {
        /// Of the blob in force.
        sequence: u32,
    },
    /// Written, read back, committed.
    Written(Slot),
}

/// Why a blob was not stored. After a [`StoreError::Write`] the next power-up
/// finds the old blob or the new one, as after a power cut; it may be tried
/// again at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StoreError<E> {
    /// It is no valid blob, not this robot's or not authentic.
    Blob(AcceptanceError),
    /// Its sequence number is not above that of the blob in use.
    NotNewer {
        /// Of the blob in use.
        stored: u32,
        /// Of the blob to be stored.
        offered: u32,
    },
    /// The blob in use could not be made to last ([`Settled::Failed`]); until
    /// an open succeeds in that, storing could lose it.
    Unsettled,
    /// This slot holds the blob in use and is not discarded.
    InUse(Slot),
    /// The slot could not be written, or may not.
    Write(WriteError<E>),
}

impl<E: fmt::Debug> fmt::Display for StoreError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Blob(error) => error.fmt(f),
            Self::NotNewer { stored, offered } => {
                write!(f, "sequence number {offered} is not above the stored {stored}")
            }
            Self::InUse(slot) => write!(f, "slot {slot} holds the blob in use"),
            Self::Unsettled => f.write_str("the blob in use could not be made to last"),
            Self::Write(error) => error.fmt(f),
        }
    }
}

impl<E: fmt::Debug + 'static> core::error::Error for StoreError<E> {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Blob(error) => Some(error),
            Self::Write(error) => Some(error),
            _ => None,
        }
    }
}

impl<E> From<AcceptanceError> for StoreError<E> {
    fn from(error: AcceptanceError) -> Self {
        Self::Blob(error)
    }
}

impl<E> From<WriteError<E>> for StoreError<E> {
    fn from(error: WriteError<E>) -> Self {
        Self::Write(error)
    }
}
