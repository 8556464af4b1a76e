use embedded_storage::nor_flash::{NorFlash, NorFlashError, NorFlashErrorKind};

use super::medium::{Fault, FaultKind, Geometry, GeometryError, Medium, Operation, Slot};

/// Two slots in a NOR flash: erase blocks, and words that are written once.
#[derive(Debug)]
pub struct NorSlots<F> {
    flash: F,
    geometry: Geometry,
}

impl<F: NorFlash> NorSlots<F> {
    /// Slots of `size` bytes at these addresses of the flash, each of whole
    /// erase blocks that hold nothing else.
    ///
    /// # Errors
    /// When the flash has no such blocks.
    pub fn new(flash: F, starts: [u32; 2], size: u32) -> Result<Self, GeometryError> {
        let word = F::WRITE_SIZE;
        if F::READ_SIZE == 0 || !word.is_multiple_of(F::READ_SIZE) {
            return Err(GeometryError::Word { word });
        }
        let geometry = Geometry::new(starts, size, word, F::ERASE_SIZE, flash.capacity())?;
        Ok(Self { flash, geometry })
    }

    /// The flash, for other uses.
    pub fn release(self) -> F {
        self.flash
    }
}

impl<F: NorFlash> Medium for NorSlots<F> {
    const WORD: usize = F::WRITE_SIZE;

    fn slot_size(&self) -> usize {
        self.geometry.size()
    }

    fn read(&mut self, slot: Slot, offset: usize, bytes: &mut [u8]) -> Result<(), Fault> {
        let address = self.geometry.address(slot, offset, bytes.len(), Operation::Read)?;
        self.flash.read(address, bytes).map_err(|error| fault(Operation::Read, &error))
    }

    fn erase(&mut self, slot: Slot) -> Result<(), Fault> {
        let (start, end) = self.geometry.range(slot);
        self.flash.erase(start, end).map_err(|error| fault(Operation::Erase, &error))
    }

    fn program(&mut self, slot: Slot, offset: usize, bytes: &[u8]) -> Result<(), Fault> {
        let address = self.geometry.address(slot, offset, bytes.len(), Operation::Program)?;
        self.flash.write(address, bytes).map_err(|error| fault(Operation::Program, &error))
    }
}

fn fault(during: Operation, error: &impl NorFlashError) -> Fault {
    let kind = match error.kind() {
        NorFlashErrorKind::NotAligned => FaultKind::NotAligned,
        NorFlashErrorKind::OutOfBounds => FaultKind::OutOfBounds,
        _ => FaultKind::Device,
    };
    Fault { during, kind }
}
