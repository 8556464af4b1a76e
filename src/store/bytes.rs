use embedded_storage::Storage;

use super::medium::{Fault, Geometry, GeometryError, Medium, Operation, Slot, is_word};

/// Two slots in a memory that needs no erasing, such as an EEPROM behind
/// `eeprom24x`. A page that is cut while it is written may lose all its bytes:
/// so a page of `PAGE` bytes is the write word, and erasing is writing 0xff.
///
/// A page that is no power of two does not compile:
/// ```compile_fail
/// # use embedded_storage::{ReadStorage, Storage};
/// # struct Part;
/// # impl ReadStorage for Part {
/// #     type Error = ();
/// #     fn read(&mut self, _: u32, _: &mut [u8]) -> Result<(), ()> { Ok(()) }
/// #     fn capacity(&self) -> usize { 4096 }
/// # }
/// # impl Storage for Part {
/// #     fn write(&mut self, _: u32, _: &[u8]) -> Result<(), ()> { Ok(()) }
/// # }
/// truearm::store::ByteSlots::<_, 24>::new(Part, [0, 1200], 1200);
/// ```
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
        const { assert!(is_word(PAGE), "a page must be a power of two up to MAX_WORD") };
        let geometry = Geometry::new(starts, size, PAGE, storage.capacity())?;
        Ok(Self { storage, geometry })
    }

    /// The memory, for other uses.
    pub fn release(self) -> S {
        self.storage
    }
}

impl<S: Storage, const PAGE: usize> Medium for ByteSlots<S, PAGE>
where
    S::Error: core::fmt::Debug,
{
    type Error = S::Error;

    const WORD: usize = PAGE;

    fn slot_size(&self) -> usize {
        self.geometry.size()
    }

    fn read(&mut self, slot: Slot, offset: usize, bytes: &mut [u8]) -> Result<(), Fault<S::Error>> {
        let address = self.geometry.address(slot, offset, bytes.len(), Operation::Read)?;
        self.storage.read(address, bytes).map_err(Fault::of(Operation::Read))
    }

    fn erase(&mut self, slot: Slot) -> Result<(), Fault<S::Error>> {
        let (start, end) = self.geometry.range(slot);
        for page in (start..end).step_by(PAGE) {
            self.storage.write(page, &[0xff; PAGE]).map_err(Fault::of(Operation::Erase))?;
        }
        Ok(())
    }

    fn program(&mut self, slot: Slot, offset: usize, bytes: &[u8]) -> Result<(), Fault<S::Error>> {
        let address = self.geometry.address(slot, offset, bytes.len(), Operation::Program)?;
        self.storage.write(address, bytes).map_err(Fault::of(Operation::Program))
    }
}
