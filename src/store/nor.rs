use embedded_storage::nor_flash::NorFlash;

use super::medium::{Fault, Geometry, GeometryError, Medium, Operation, Slot, is_word};

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
        const {
            assert!(is_word(F::WRITE_SIZE), "a write word must be a power of two up to MAX_WORD");
            assert!(
                F::READ_SIZE > 0 && F::WRITE_SIZE.is_multiple_of(F::READ_SIZE),
                "a write word must be readable by itself"
            );
            assert!(
                F::ERASE_SIZE > 0 && F::ERASE_SIZE.is_multiple_of(F::WRITE_SIZE),
                "an erase block must have whole write words"
            );
        }
        let geometry = Geometry::new(starts, size, F::ERASE_SIZE, flash.capacity())?;
        Ok(Self { flash, geometry })
    }

    /// The flash, for other uses.
    pub fn release(self) -> F {
        self.flash
    }
}

impl<F: NorFlash> Medium for NorSlots<F> {
    type Error = F::Error;

    const WORD: usize = F::WRITE_SIZE;

    fn slot_size(&self) -> usize {
        self.geometry.size()
    }

    fn read(&mut self, slot: Slot, offset: usize, bytes: &mut [u8]) -> Result<(), Fault<F::Error>> {
        let address = self.geometry.address(slot, offset, bytes.len(), Operation::Read)?;
        self.flash.read(address, bytes).map_err(Fault::of(Operation::Read))
    }

    fn erase(&mut self, slot: Slot) -> Result<(), Fault<F::Error>> {
        let (start, end) = self.geometry.range(slot);
        self.flash.erase(start, end).map_err(Fault::of(Operation::Erase))
    }

    fn program(&mut self, slot: Slot, offset: usize, bytes: &[u8]) -> Result<(), Fault<F::Error>> {
        let address = self.geometry.address(slot, offset, bytes.len(), Operation::Program)?;
        self.flash.write(address, bytes).map_err(Fault::of(Operation::Program))
    }
}
