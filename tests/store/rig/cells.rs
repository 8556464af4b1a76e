//! Parts: memory behind a driver behind an adapter, as flash or as EEPROM.

use std::rc::Rc;

use embedded_storage::nor_flash::{self, NorFlash, NorFlashErrorKind, ReadNorFlash};
use embedded_storage::{ReadStorage, Storage};
use truearm::store::{ByteSlots, Medium, NorSlots};

pub use super::memory::{Cells, Cut, Shared, Tear};

/// NOR flash with words of `W` bytes and erase blocks of `E`.
#[derive(Debug)]
pub struct Nor<const W: usize, const E: usize>(Shared);

impl<const W: usize, const E: usize> Nor<W, E> {
    pub fn new(cells: &Shared) -> Self {
        Self(Rc::clone(cells))
    }
}

impl<const W: usize, const E: usize> nor_flash::ErrorType for Nor<W, E> {
    type Error = NorFlashErrorKind;
}

impl<const W: usize, const E: usize> ReadNorFlash for Nor<W, E> {
    const READ_SIZE: usize = if W < 4 { 1 } else { 4 };

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        nor_flash::check_read(self, offset, bytes.len())?;
        self.0.borrow_mut().read(offset as usize, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.borrow().bytes.len()
    }
}

impl<const W: usize, const E: usize> NorFlash for Nor<W, E> {
    const WRITE_SIZE: usize = W;
    const ERASE_SIZE: usize = E;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        nor_flash::check_erase(self, from, to)?;
        for start in (from as usize..to as usize).step_by(E) {
            let cells = &mut self.0.borrow_mut();
            cells.change(start, &[0xff; E])?;
            cells.may_be_written(start, E);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        nor_flash::check_write(self, offset, bytes.len())?;
        for (word, start) in bytes.chunks(W).zip((offset as usize..).step_by(W)) {
            let cells = &mut self.0.borrow_mut();
            if !cells.dead {
                cells.write_once(start, W);
            }
            cells.change(start, word)?;
        }
        Ok(())
    }
}

/// EEPROM with pages of `P` bytes: a page that is cut may change in all bytes.
#[derive(Debug)]
pub struct Eeprom<const P: usize>(Shared);

impl<const P: usize> Eeprom<P> {
    pub fn new(cells: &Shared) -> Self {
        Self(Rc::clone(cells))
    }
}

impl<const P: usize> ReadStorage for Eeprom<P> {
    type Error = NorFlashErrorKind;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.0.borrow_mut().read(offset as usize, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.borrow().bytes.len()
    }
}

impl<const P: usize> Storage for Eeprom<P> {
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let mut offset = offset as usize;
        let mut rest = bytes;
        while !rest.is_empty() {
            let page = offset / P * P;
            let (piece, after) = rest.split_at(rest.len().min(page + P - offset));
            let cells = &mut self.0.borrow_mut();
            let mut whole = cells.bytes[page..page + P].to_vec();
            whole[offset - page..][..piece.len()].copy_from_slice(piece);
            cells.change(page, &whole)?;
            (offset, rest) = (offset + piece.len(), after);
        }
        Ok(())
    }
}

/// A part: memory cells behind a driver behind an adapter.
pub trait Part {
    const NAME: &str;
    /// Bytes of a slot must be a multiple of this.
    const BLOCK: usize;
    /// Whether a word that was cut may fail at one reading and not at the next.
    const ECC: bool = false;
    type Slots: Medium;
    fn mount(cells: &Shared, slot_size: usize) -> Self::Slots;
}

/// NOR flash of the given word and block size.
#[derive(Debug)]
pub struct NorPart<const W: usize, const E: usize>;

impl<const W: usize, const E: usize> Part for NorPart<W, E> {
    const NAME: &str = match W {
        1 => "NOR, 1-byte words",
        4 => "NOR, 4-byte words",
        8 => "NOR, 8-byte words",
        32 => "NOR, 32-byte words",
        _ => "NOR",
    };
    const BLOCK: usize = E;
    type Slots = NorSlots<Nor<W, E>>;

    fn mount(cells: &Shared, slot_size: usize) -> Self::Slots {
        let size = slot_size as u32;
        NorSlots::new(Nor::new(cells), [0, size], size).expect("a geometry of whole blocks")
    }
}

/// The same with an ECC: its driver says that it cannot read what was half
/// written.
#[derive(Debug)]
pub struct EccPart<const W: usize, const E: usize>;

impl<const W: usize, const E: usize> Part for EccPart<W, E> {
    const NAME: &str = match W {
        4 => "NOR with ECC, 4-byte words",
        8 => "NOR with ECC, 8-byte words",
        32 => "NOR with ECC, 32-byte words",
        _ => "NOR with ECC",
    };
    const BLOCK: usize = E;
    const ECC: bool = true;
    type Slots = NorSlots<Nor<W, E>>;

    fn mount(cells: &Shared, slot_size: usize) -> Self::Slots {
        cells.borrow_mut().ecc = W;
        NorPart::<W, E>::mount(cells, slot_size)
    }
}

/// EEPROM of the given page size.
#[derive(Debug)]
pub struct EepromPart<const P: usize>;

impl<const P: usize> Part for EepromPart<P> {
    const NAME: &str = match P {
        8 => "EEPROM, 8-byte pages",
        32 => "EEPROM, 32-byte pages",
        _ => "EEPROM",
    };
    const BLOCK: usize = P;
    type Slots = ByteSlots<Eeprom<P>, P>;

    fn mount(cells: &Shared, slot_size: usize) -> Self::Slots {
        let size = slot_size as u32;
        ByteSlots::new(Eeprom::new(cells), [0, size], size).expect("a geometry of whole pages")
    }
}
