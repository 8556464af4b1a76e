//! What the store accepts, refuses, falls back to and leaves alone.

use std::cell::RefCell;
use std::rc::Rc;

use embedded_storage::nor_flash::NorFlashErrorKind;
use truearm::blob::{Acceptance, AcceptanceError, Blob, DecodeError};
use truearm::store::{
    FaultKind, GeometryError, NorSlots, Opened, Rejection, Settled, Slot, SlotState, Source, Store,
    StoreError, Stored,
};

use super::rig::cells::{Cells, Nor, NorPart, Part, Shared};
use super::rig::samples::{self, full};

pub type Flash = NorPart<8, 512>;
pub type Error = NorFlashErrorKind;
pub const SLOT: usize = 1024;

pub fn flash() -> Shared {
    Rc::new(RefCell::new(Cells::blank(2 * SLOT)))
}

pub fn mine() -> Acceptance {
    samples::mine(&full(0, 0))
}

pub fn open<'b>(
    cells: &Shared,
    buffer: &'b mut [u8],
) -> (Store<<Flash as Part>::Slots>, Opened<'b, Error>) {
    cells.borrow_mut().power_up(None);
    Store::open(Flash::mount(cells, SLOT), buffer, mine()).expect("room for a blob")
}

pub fn store(cells: &Shared, blob: &[u8]) -> Result<Stored, StoreError<Error>> {
    open(cells, &mut [0; SLOT]).0.store(blob)
}

/// Where there is none, or an older one.
pub fn fresh(cells: &Shared, blob: &[u8]) {
    let stored = store(cells, blob).expect("an empty store or a newer blob");
    assert!(matches!(stored, Stored::Written(_)));
}

pub fn source(cells: &Shared) -> Source<Error> {
    open(cells, &mut [0; SLOT]).1.source
}

#[test]
fn slots_take_turns_and_the_newest_is_found() {
    let cells = flash();
    assert_eq!(source(&cells), Source::Nominal([SlotState::Blank; 2]));
    for (sequence, slot) in [(1, Slot::A), (2, Slot::B), (7, Slot::A)] {
        assert_eq!(store(&cells, &full(sequence, sequence as u8)), Ok(Stored::Written(slot)));
        let mut buffer = [0; SLOT];
        let (_, opened) = open(&cells, &mut buffer);
        assert_eq!((opened.source, opened.settled), (Source::Newest(slot), Settled::Already));
        assert_eq!(opened.blob, Blob::check(&full(sequence, sequence as u8)).ok());
    }
}

#[test]
fn the_same_parameters_write_nothing() {
    let cells = flash();
    fresh(&cells, &full(5, 1));
    let before = cells.borrow().bytes.clone();
    for offered in [4, 5] {
        assert_eq!(store(&cells, &full(offered, 1)), Ok(Stored::Unchanged { sequence: 5 }));
    }
    assert_eq!((cells.borrow().operations, &cells.borrow().bytes), (0, &before));
}

/// A counter that only goes up follows what was stored or offered: the next
/// power-up finds the parameters, also where they differ in their number alone.
#[test]
fn a_counter_that_follows_the_store_refuses_nothing() {
    let cells = flash();
    for offered in [2, 12, 12, 7, 13] {
        let _ = store(&cells, &full(offered, 1)).expect("the same parameters");
        let mut buffer = [0; SLOT];
        let (store, _) = open(&cells, &mut buffer);
        let (_, sequence) = store.live().expect("parameters");
        assert!(sequence >= offered, "{sequence} in force after {offered} was stored");
        let slots = Flash::mount(&cells, SLOT);
        let (store, _) =
            Store::open(slots, &mut buffer, mine().not_before(sequence)).expect("room for a blob");
        assert_eq!(store.live().map(|(_, sequence)| sequence), Some(sequence));
    }
}

#[test]
fn what_a_programmer_writes_is_taken_as_it_is() {
    let cells = flash();
    fresh(&cells, &full(5, 1));
    cells.borrow_mut().flash(SLOT, &full(6, 2), SLOT);
    let before = cells.borrow().bytes.clone();
    assert_eq!(source(&cells), Source::Newest(Slot::B));
    assert_eq!(cells.borrow().bytes, before);
    assert_eq!(store(&cells, &full(7, 3)), Ok(Stored::Written(Slot::A)));
}

#[test]
fn an_older_sequence_is_refused_and_writes_nothing() {
    let cells = flash();
    fresh(&cells, &full(5, 1));
    for offered in [0, 4, 5] {
        let refused = StoreError::NotNewer { stored: 5, offered };
        assert_eq!(store(&cells, &full(offered, 2)), Err(refused));
        assert_eq!(cells.borrow().operations, 0);
    }
}

#[test]
fn another_robot_is_refused_and_left_alone() {
    let cells = flash();
    let mut other = full(9, 1);
    other[16] ^= 1;
    samples::seal(&mut other);
    let robot = Blob::check(&full(9, 1)).expect("a blob").robot_id();
    let wrong = AcceptanceError::WrongRobot { blob: robot ^ 1, robot };
    assert_eq!(store(&cells, &other), Err(StoreError::Blob(wrong)));
    fresh(&cells, &full(5, 1));
    cells.borrow_mut().flash(SLOT, &other, SLOT);
    let rejected = Rejection::Blob(wrong);
    assert_eq!(source(&cells), Source::LastGood { slot: Slot::A, rejected });
    assert_eq!(&cells.borrow().bytes[SLOT..][..other.len()], other);
}

#[test]
fn damaged_blobs_are_refused_by_the_store() {
    let cells = flash();
    let mut damaged = full(9, 1);
    damaged[100] ^= 4;
    assert!(matches!(
        store(&cells, &damaged),
        Err(StoreError::Blob(AcceptanceError::Damaged(DecodeError::Checksum { .. })))
    ));
    assert_eq!(cells.borrow().operations, 0);
}

/// Every bit of the newer blob rots, one at a time: the older one is found,
/// with the reason, and the rotten one is left for whoever wants to see it.
#[test]
fn bit_rot_falls_back_to_the_last_good() {
    let cells = flash();
    fresh(&cells, &full(1, 1));
    fresh(&cells, &full(2, 2));
    let whole = cells.borrow().clone();
    for bit in 0..8 * full(2, 2).len() {
        let mut rotten = whole.clone();
        rotten.bytes[SLOT + bit / 8] ^= 1 << (bit % 8);
        let before = rotten.bytes.clone();
        let cells = Rc::new(RefCell::new(rotten));
        let mut buffer = [0; SLOT];
        let (_, opened) = open(&cells, &mut buffer);
        let Source::LastGood { slot: Slot::A, rejected: Rejection::Blob(_) } = opened.source else {
            panic!("bit {bit}: {:?}", opened.source);
        };
        assert_eq!(opened.blob, Blob::check(&full(1, 1)).ok());
        assert_eq!(cells.borrow().bytes, before);
    }
}

/// Rot in the marks is no reason to touch a blob.
#[test]
fn bit_rot_of_the_marks_loses_nothing() {
    let cells = flash();
    fresh(&cells, &full(1, 1));
    fresh(&cells, &full(2, 2));
    let whole = cells.borrow().clone();
    for bit in 0..8 * 16 {
        let mut rotten = whole.clone();
        rotten.bytes[2 * SLOT - 16 + bit / 8] ^= 1 << (bit % 8);
        let cells = Rc::new(RefCell::new(rotten));
        let mut buffer = [0; SLOT];
        let (_, opened) = open(&cells, &mut buffer);
        assert_eq!(opened.source, Source::Newest(Slot::B));
        assert_eq!(opened.settled, Settled::Already, "bit {bit}");
    }
}

#[test]
fn a_dead_device_is_reported() {
    let cells = flash();
    fresh(&cells, &full(1, 1));
    cells.borrow_mut().dead = true;
    let mut buffer = [0; SLOT];
    let slots = Flash::mount(&cells, SLOT);
    let (_, opened) = Store::open(slots, &mut buffer, mine()).expect("room for a blob");
    let Source::Nominal([SlotState::Rejected(Rejection::Fault(fault)), _]) = opened.source else {
        panic!("{:?}", opened.source);
    };
    assert_eq!(fault.kind, FaultKind::Driver(NorFlashErrorKind::Other));
    assert_eq!(fault.to_string(), "reading: the driver says Other");
}

#[test]
fn slots_must_fit_the_device() {
    let cells = flash();
    let nor = |starts, size| NorSlots::new(Nor::<8, 512>::new(&cells), starts, size).err();
    assert_eq!(nor([0, 1024], 1024), None);
    assert_eq!(nor([0, 1024], 1000), Some(GeometryError::Boundary { every: 512 }));
    assert_eq!(nor([0, 8], 512), Some(GeometryError::Boundary { every: 512 }));
    assert_eq!(nor([512, 0], 1024), Some(GeometryError::Overlap));
    assert_eq!(nor([0, 1536], 1024), Some(GeometryError::Capacity { capacity: 2048 }));
    assert_eq!(nor([0, u32::MAX - 511], 512), Some(GeometryError::Capacity { capacity: 2048 }));
}

/// The compiler warns of what was stored, or was not as it was there, when nobody looks.
#[test]
#[expect(unused_must_use)]
#[deny(unfulfilled_lint_expectations)]
fn what_was_stored_and_is_dropped_is_warned_of() {
    store(&flash(), &full(1, 1)).unwrap();
}
