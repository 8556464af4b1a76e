//! Parameters that survive, in flash and in an EEPROM, and the thermometer.

use core::hint::black_box;

use embedded_storage::nor_flash::NorFlashErrorKind;
use truearm::ArmParameters6;
use truearm::blob::{Acceptance, EncodeError, encode_with, sign};
use truearm::sensor::{TEMPERATURE_SENSOR, read_temperature};
use truearm::store::{
    ByteSlots, GeometryError, Medium, NorSlots, Opened, Slot, Store, StoreError, Stored,
};

use super::compute;
use super::parts::{Bus, Eeprom, Flash};

type Slots = NorSlots<Flash>;
type Open<'b> = (Store<Slots>, Opened<'b, NorFlashErrorKind>);

// The names of these three are what xtask sums up as the store's text.

#[inline(never)]
fn store_slots(starts: [u32; 2], size: u32) -> Result<Slots, GeometryError> {
    NorSlots::new(Flash, starts, size)
}

#[inline(never)]
fn store_open<'b>(slots: Slots, buffer: &'b mut [u8]) -> Result<Open<'b>, GeometryError> {
    Store::open(slots, buffer, Acceptance::of(black_box(1), 6))
}

#[inline(never)]
fn store_store(
    store: &mut Store<Slots>,
    bytes: &[u8],
) -> Result<Stored, StoreError<NorFlashErrorKind>> {
    store.store(bytes)
}

pub fn flash(bytes: &[u8], buffer: &mut [u8]) -> Result<(), GeometryError> {
    let slots = store_slots(black_box([0, 4096]), black_box(4096))?;
    let (mut store, opened) = store_open(slots, black_box(buffer))?;
    compute(opened);
    compute(store_store(&mut store, black_box(bytes)));
    finish(store);
    Ok(())
}

pub fn eeprom(bytes: &[u8], buffer: &mut [u8]) -> Result<(), GeometryError> {
    let slots = ByteSlots::<_, 32>::new(Eeprom, black_box([0, 4096]), black_box(4096))?;
    let mine = Acceptance::of(black_box(1), 6).with_key(black_box([3; 32]));
    let (mut store, opened) = Store::open(slots, black_box(buffer), mine)?;
    if let Some(Ok(parameters)) = opened.blob.map(|blob| blob.parameters::<f32, 6>()) {
        let mut room = [0; 1024];
        compute(again(&parameters, &mut room));
        compute(store.store(black_box(&room)));
    }
    compute(store.store(black_box(bytes)));
    finish(store);
    compute(read_temperature(&mut Bus, black_box(TEMPERATURE_SENSOR)));
    Ok(())
}

fn finish<M: Medium>(mut store: Store<M>) {
    compute(store.discard(black_box(Slot::A)));
    compute((store.live(), store.release()));
}

/// What is stored after a re-identification.
fn again(parameters: &ArmParameters6<'_, f32>, room: &mut [u8]) -> Result<usize, EncodeError> {
    encode_with(parameters, Some(black_box(&[0.0; 100])), room)?;
    sign(room, black_box(&[3; 32]))
}
