use embedded_storage::Storage;

use super::medium::{Fault, FaultKind, Geometry, GeometryError, Medium, Operation, Slot};

/// Two slots in a memory that needs no erasing, such as an EEPROM behind
/// `eeprom24x`. A page that is cut while it is written may lose all its bytes:
/// so a page of `PAGE` bytes is the write word, and erasing is writing 0xff.
#[derive(Debug)]
pub struct ByteSlots<S, const PAGE: usize> {
    storage: S,
    geometry: Geometry,
}

impl<S: Storage, const PAGE: usize> ByteSlots<S, PAGE> {
    /// Slots of `size` bytes at these addresses, each of whole pages.
    ///
    /// # Errors
    /// When the device has no such pages.
    pub fn new(storage: S, starts: [u32; 2], size: u32) -> Result<Self, GeometryError> {
        let geometry = Geometry::new(starts, size, PAGE, PAGE, storage.capacity())?;
        Ok(Self { storage, geometry })
    }

    /// The memory, for other uses.
    pub fn release(self) -> S {
        self.storage
    }
}

impl<S: Storage, const PAGE: usize> Medium for ByteSlots<S, PAGE> {
    const WORD: usize = PAGE;

    fn slot_size(&self) -> usize {
        self.geometry.size()
    }

    fn read(&mut self, slot: Slot, offset: usize, bytes: &mut [u8]) -> Result<(), Fault> {
        let address = self.geometry.address(slot, offset, bytes.len(), Operation::Read)?;
        let fault = Fault { during: Operation::Read, kind: FaultKind::Device };
        self.storage.read(address, bytes).map_err(|_| fault)
    }

    fn erase(&mut self, slot: Slot) -> Result<(), Fault> {
        let (start, end) = self.geometry.range(slot);
        let fault = Fault { during: Operation::Erase, kind: FaultKind::Device };
        for page in (start..end).step_by(PAGE) {
            self.storage.write(page, &[0xff; PAGE]).map_err(|_| fault)?;
        }
        Ok(())
    }

    fn program(&mut self, slot: Slot, offset: usize, bytes: &[u8]) -> Result<(), Fault> {
        let address = self.geometry.address(slot, offset, bytes.len(), Operation::Program)?;
        let fault = Fault { during: Operation::Program, kind: FaultKind::Device };
        self.storage.write(address, bytes).map_err(|_| fault)
    }
}
