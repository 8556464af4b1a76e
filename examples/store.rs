//! New parameters survive a power cut: two slots of a NOR flash, one of which
//! always holds good ones. The flash is in RAM here and can lose its power.
//!
//! `cargo run --example store`

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use truearm::ArmParameters6;
use truearm::blob::{Acceptance, Blob, EncodeError, encode, encoded_len};
use truearm::store::{GeometryError, NorSlots, Settled, Source, Store, StoreError};

static FIRST: &[u8] = include_bytes!("../tests/data/firmware/ur10.blob");
/// As `truearm inspect` prints it.
const ROBOT_ID: u64 = 0x544a_b5f3_0b94_225d;
const BLOCK: u32 = 4096;

/// Words of 8 bytes, blocks of 4 KiB.
struct Flash {
    bytes: Vec<u8>,
    /// Words that it still writes before the power fails.
    words: u32,
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let from = offset as usize;
        let stored = self.bytes.get(from..from + bytes.len());
        bytes.copy_from_slice(stored.ok_or(NorFlashErrorKind::OutOfBounds)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = BLOCK as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        let block = self.bytes.get_mut(from as usize..to as usize);
        block.ok_or(NorFlashErrorKind::OutOfBounds)?.fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        for (word, from) in bytes.chunks(Self::WRITE_SIZE).zip((offset as usize..).step_by(8)) {
            self.words = self.words.checked_sub(1).ok_or(NorFlashErrorKind::Other)?;
            let place = self.bytes.get_mut(from..from + word.len());
            place.ok_or(NorFlashErrorKind::OutOfBounds)?.copy_from_slice(word);
        }
        Ok(())
    }
}

/// What the robot would work with after power-up: the sequence number of its
/// parameters, `None` for nominal ones.
fn power_up(flash: Flash) -> Result<(Store<NorSlots<Flash>>, Option<u32>), GeometryError> {
    let slots = NorSlots::new(Flash { words: u32::MAX, ..flash }, [0, BLOCK], BLOCK)?;
    // As long as the longest blob to come; where the arm is to keep tables of
    // its blob, a static.
    let mut buffer = [0; 1024];
    let (store, opened) = Store::open(slots, &mut buffer, Acceptance::of(ROBOT_ID, 6))?;
    match opened.source {
        Source::Newest(slot) => println!("power-up: parameters from slot {slot}"),
        Source::LastGood { slot, rejected } => {
            println!("power-up: from slot {slot}; the other one: {rejected}");
        }
        Source::Nominal(states) => println!("power-up: nominal; {states:?}"),
    }
    if let Settled::Failed(error) = opened.settled {
        println!("power-up: may be gone at the next, the slot cannot be written: {error:?}");
    }
    let sequence = opened.blob.map(|blob| blob.sequence());
    Ok((store, sequence))
}

/// A newer set: the tool was changed. Of the same numbers nothing would be stored.
fn newer(blob: &[u8]) -> Result<Vec<u8>, EncodeError> {
    let checked = Blob::check(blob).and_then(|blob| blob.parameters());
    let mut parameters: ArmParameters6<'_, f32> = checked.map_err(EncodeError::Refused)?;
    parameters.sequence += 1;
    parameters.tool.x += 1e-3;
    let mut bytes = vec![0; encoded_len(6, parameters.terms.len())];
    encode(&parameters, &mut bytes)?;
    Ok(bytes)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let flash = Flash { bytes: vec![0xff; 2 * BLOCK as usize], words: u32::MAX };
    let (mut store, none) = power_up(flash)?;
    assert_eq!(none, None, "a blank flash");
    println!("stored: {:?}", store.store(FIRST)?);

    let (store, first) = power_up(store.release().release())?;
    let first = first.ok_or("what was stored is there")?;

    // The power fails while the next set is written...
    let second = newer(FIRST)?;
    let flash = Flash { words: 30, ..store.release().release() };
    let slots = NorSlots::new(flash, [0, BLOCK], BLOCK)?;
    let mut buffer = [0; 1024];
    let (mut store, _) = Store::open(slots, &mut buffer, Acceptance::of(ROBOT_ID, 6))?;
    match store.store(&second) {
        Err(StoreError::Write(error)) => println!("not stored: {error}"),
        other => return Err(format!("30 words are too few, but: {other:?}").into()),
    }

    // ... and the old one is there, unharmed. The next attempt comes through.
    let (mut store, after_the_cut) = power_up(store.release().release())?;
    assert_eq!(after_the_cut, Some(first));
    println!("stored: {:?}", store.store(&second)?);
    let (_, last) = power_up(store.release().release())?;
    assert_eq!(last, Some(first + 1));
    Ok(())
}
