use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// A NOR flash whose words carry an error-correcting code, for
/// [`NorSlots`](super::NorSlots): a word that the driver cannot read because a
/// power cut tore it is read as zeros.
///
/// The store cannot tell such a word from a memory that does not answer, and
/// what cannot be read it does not erase: stores would end in
/// [`WriteError::Occupied`](super::WriteError::Occupied) from then on. The
/// driver's error can tell. Zeros are what no store left behind: a commit word
/// of zeros is no blob, and a `DONE` of zeros one that was begun.
///
/// `uncorrectable` is asked of each error of a reading. True must mean that
/// these bytes are lost and all others are not, never that the device is busy or
/// gone: what is read as zeros may be erased. The driver must come back with an
/// error in the first place; where the part answers with a fault of the bus or an
/// interrupt (STM32 G4, L4, H7), its handler has to tell the driver.
///
/// ```
/// # use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
/// use truearm::store::{EccNor, NorSlots};
///
/// #[derive(Debug, PartialEq)]
/// enum FlashError {
///     DoubleBit,
///     Busy,
/// }
/// # impl NorFlashError for FlashError {
/// #     fn kind(&self) -> NorFlashErrorKind { NorFlashErrorKind::Other }
/// # }
/// # struct Flash;
/// # impl ErrorType for Flash { type Error = FlashError; }
/// # impl ReadNorFlash for Flash {
/// #     const READ_SIZE: usize = 1;
/// #     fn read(&mut self, at: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
/// #         bytes.fill(0xff);
/// #         let end = at as usize + bytes.len();
/// #         if at < 16 && end > 8 { Err(FlashError::DoubleBit) } else { Ok(()) }
/// #     }
/// #     fn capacity(&self) -> usize { 4096 }
/// # }
/// # impl NorFlash for Flash {
/// #     const WRITE_SIZE: usize = 8;
/// #     const ERASE_SIZE: usize = 2048;
/// #     fn erase(&mut self, _: u32, _: u32) -> Result<(), FlashError> { Ok(()) }
/// #     fn write(&mut self, _: u32, _: &[u8]) -> Result<(), FlashError> { Ok(()) }
/// # }
///
/// let mut flash = EccNor::new(Flash, |error: &FlashError| *error == FlashError::DoubleBit);
/// # let mut bytes = [1; 32];
/// # flash.read(0, &mut bytes).unwrap();
/// # let mut expected = [0xff; 32];
/// # expected[8..16].fill(0);
/// # assert_eq!(bytes, expected);
/// let slots = NorSlots::new(flash, [0, 2048], 2048);
/// # assert!(slots.is_ok());
/// ```
#[derive(Debug)]
pub struct EccNor<F, P> {
    flash: F,
    uncorrectable: P,
}

impl<F: ReadNorFlash, P: Fn(&F::Error) -> bool> EccNor<F, P> {
    /// A flash, and which of its errors of reading say that the bytes are lost.
    pub const fn new(flash: F, uncorrectable: P) -> Self {
        const { assert!(F::READ_SIZE > 0, "something must be readable by itself") };
        Self { flash, uncorrectable }
    }

    /// The flash, for other uses.
    pub fn release(self) -> F {
        self.flash
    }
}

impl<F: ErrorType, P> ErrorType for EccNor<F, P> {
    type Error = F::Error;
}

impl<F: ReadNorFlash, P: Fn(&F::Error) -> bool> ReadNorFlash for EccNor<F, P> {
    const READ_SIZE: usize = F::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), F::Error> {
        match self.flash.read(offset, bytes) {
            Err(error) if (self.uncorrectable)(&error) => (),
            done => return done,
        }
        // Once more piece by piece: what can be read is needed.
        let (mut at, mut rest) = (offset, bytes);
        while let Some((piece, after)) = rest.split_at_mut_checked(F::READ_SIZE) {
            match self.flash.read(at, piece) {
                Err(error) if (self.uncorrectable)(&error) => piece.fill(0),
                done => done?,
            }
            at = at.wrapping_add(F::READ_SIZE as u32);
            rest = after;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl<F: NorFlash, P: Fn(&F::Error) -> bool> NorFlash for EccNor<F, P> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), F::Error> {
        self.flash.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), F::Error> {
        self.flash.write(offset, bytes)
    }
}
