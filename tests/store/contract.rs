//! What the store agreed to at `open`, and that it erases nothing else.

use std::cell::RefCell;
use std::rc::Rc;

use truearm::blob::{Acceptance, AcceptanceError, Blob, DecodeError, FieldName, Flaw, Record};
use truearm::store::{
    GeometryError, Rejection, Settled, Slot, SlotState, Source, Store, StoreError, Stored,
    WriteError,
};

use super::rig::cells::{Cells, Cut, NorPart, Part, Shared, Tear};
use super::rig::samples::{full, seal, short};
use super::rules::{Error, Flash, SLOT, flash, fresh, mine, open, source, store};

/// The full blob with some bytes changed and the checksum mended.
fn forged(sequence: u32, offset: usize, bytes: &[u8]) -> Vec<u8> {
    let mut blob = full(sequence, 1);
    blob[offset..][..bytes.len()].copy_from_slice(bytes);
    seal(&mut blob);
    blob
}

fn another_robots(sequence: u32) -> Vec<u8> {
    let robot = Blob::check(&full(1, 1)).expect("a blob").robot_id() ^ 1;
    forged(sequence, 16, &robot.to_le_bytes())
}

/// Blobs that are whole and refused: another robot's, of another number of
/// joints, of a newer layout, with a flag, an effect or a value to come, longer
/// than the arm's buffer, that none could follow.
fn refused() -> Vec<(&'static str, Vec<u8>)> {
    let mut effect = short(6, 1, 9, 1);
    let at = effect.len() - 12;
    effect[at] = 15;
    seal(&mut effect);
    let mut flag = full(9, 1);
    flag[28] |= 0x80;
    flag.extend([7; 200]);
    let length = flag.len() as u32;
    flag[8..12].copy_from_slice(&length.to_le_bytes());
    seal(&mut flag);
    vec![
        ("another robot's", another_robots(9)),
        ("of seven joints", short(7, 0, 9, 1)),
        ("of five joints", short(5, 0, 9, 1)),
        ("of a newer layout", forged(9, 4, &[4, 0])),
        ("with a part to come", flag),
        ("with an effect to come", effect),
        ("with a range to come", forged(9, 76, &250_f32.to_le_bytes())),
        ("of the last sequence number", full(u32::MAX, 1)),
    ]
}

/// Stores a blob, whoever takes it, and cuts the power just before `DONE`.
fn store_without_end(cells: &Shared, blob: &[u8], slot: Slot) {
    cells.borrow_mut().power_up(None);
    let start = if slot == Slot::A { 0 } else { SLOT };
    let (begun, done) = (SLOT - 16, SLOT - 8);
    let mut bytes = vec![0xff; SLOT];
    bytes[..blob.len()].copy_from_slice(blob);
    bytes[begun..done].copy_from_slice(b"BEGN\0\0\0\0");
    bytes[begun + 4..done].copy_from_slice(&blob[blob.len() - 4..]);
    cells.borrow_mut().flash(start, &bytes, SLOT);
}

fn slot(cells: &Shared, slot: Slot) -> Vec<u8> {
    let start = if slot == Slot::A { 0 } else { SLOT };
    cells.borrow().bytes[start..][..SLOT].to_vec()
}

/// With every byte and mark of a store but `DONE`, and as a programmer writes
/// it; alone and beside good parameters.
#[test]
fn what_is_whole_and_refused_is_never_erased() {
    for (what, blob) in refused() {
        for unfinished in [false, true] {
            for good in [false, true] {
                let cells = flash();
                let put = if good { Slot::B } else { Slot::A };
                if good {
                    fresh(&cells, &full(1, 1));
                }
                if unfinished {
                    store_without_end(&cells, &blob, put);
                } else {
                    let start = if good { SLOT } else { 0 };
                    cells.borrow_mut().flash(start, &blob, SLOT);
                }
                let before = slot(&cells, put);
                let mut buffer = [0; SLOT];
                let (mut store, opened) = open(&cells, &mut buffer);
                assert_eq!(opened.settled, Settled::Already, "{what}");
                let found = opened.blob.map(|blob| blob.sequence());
                assert_eq!(found, good.then_some(1), "{what}");
                for sequence in [10, 11] {
                    let stored = store.store(&full(sequence, sequence as u8));
                    if good || sequence == 11 {
                        let occupied = StoreError::Write(WriteError::Occupied(put));
                        assert_eq!(stored, Err(occupied), "{what}");
                    } else {
                        assert_eq!(stored, Ok(Stored::Written(Slot::B)), "{what}");
                    }
                }
                assert_eq!(slot(&cells, put), before, "{what}");
                // Only on purpose.
                assert_eq!(store.discard(put), Ok(()));
                assert_eq!(store.store(&full(12, 12)), Ok(Stored::Written(put)));
                assert_eq!(source(&cells), Source::Newest(put));
            }
        }
    }
}

#[test]
fn each_refusal_has_its_name() {
    let names: Vec<_> = refused().iter().map(|(_, blob)| mine().check(blob).map(drop)).collect();
    let field = |record, group, flaw| {
        DecodeError::Field(FieldName { record, group, member: "" }, flaw).into()
    };
    let robot = Blob::check(&full(1, 1)).expect("a blob").robot_id();
    let expected: [AcceptanceError; 8] = [
        AcceptanceError::WrongRobot { blob: robot ^ 1, robot },
        AcceptanceError::WrongJoints { blob: 7, robot: 6 },
        AcceptanceError::WrongJoints { blob: 5, robot: 6 },
        DecodeError::NewerLayout(4).into(),
        field(Record::Header, "flags", Flaw::Unknown),
        field(Record::Term(0), "effect", Flaw::Unknown),
        field(Record::Header, "reference temperature", Flaw::Implausible),
        AcceptanceError::LastSequence,
    ];
    assert_eq!(names, expected.map(Err));
}

/// What reads damaged is undone, whoever's it was.
#[test]
fn what_a_store_began_and_is_damaged_is_erased() {
    for (what, mut blob) in refused() {
        let cells = flash();
        let last = blob.len() - 5;
        blob[last] ^= 1;
        store_without_end(&cells, &blob, Slot::B);
        let mut buffer = [0; SLOT];
        let (_, opened) = open(&cells, &mut buffer);
        assert_eq!(opened.settled, Settled::Erased, "{what}");
        assert_eq!(slot(&cells, Slot::B), [0xff; SLOT]);
    }
}

#[test]
fn nothing_is_stored_that_the_buffer_could_not_read_back() {
    let cells = flash();
    let long = short(6, 24, 1, 1);
    let mut buffer = [0; 700];
    let (mut store, _) = open(&cells, &mut buffer);
    let refused = WriteError::TooLong { needed: long.len(), room: 696 };
    assert_eq!(store.store(&long), Err(StoreError::Write(refused)));
    assert_eq!(cells.borrow().operations, 0);
    // The longest that is taken is found again.
    let longest = short(6, 16, 1, 1);
    assert_eq!(longest.len(), 692);
    assert_eq!(store.store(&longest), Ok(Stored::Written(Slot::A)));
    let (_, opened) = open(&cells, &mut buffer);
    assert_eq!(opened.blob, Blob::check(&longest).ok());
}

/// Stored with a long buffer, whole, cut before `DONE` or not; then opened with
/// a short one.
#[test]
fn a_short_buffer_erases_nothing() {
    let long = short(6, 24, 5, 1);
    let truncated = DecodeError::Truncated { needed: long.len(), got: 600 };
    let rejected = || Rejection::<Error>::Blob(AcceptanceError::Damaged(truncated));
    for unfinished in [false, true] {
        let cells = flash();
        if unfinished {
            store_without_end(&cells, &long, Slot::A);
        } else {
            fresh(&cells, &long);
        }
        let before = cells.borrow().bytes.clone();
        let mut buffer = [0; 600];
        let (mut store, opened) = open(&cells, &mut buffer);
        let states = [SlotState::Rejected(rejected()), SlotState::Blank];
        assert_eq!(opened.source, Source::Nominal(states));
        assert_eq!(opened.settled, Settled::Already);
        assert_eq!(cells.borrow().bytes, before);
        // A blob that fits has the other slot.
        assert_eq!(store.store(&full(2, 2)), Ok(Stored::Written(Slot::B)));
        assert_eq!(slot(&cells, Slot::A), before[..SLOT]);
    }
}

/// Two slots of 640 bytes.
fn open_with(
    buffer: &mut [u8],
    accept: Acceptance,
) -> Result<Store<<NorPart<4, 128> as Part>::Slots>, GeometryError> {
    let cells = Rc::new(RefCell::new(Cells::blank(2 * 640)));
    let slots = NorPart::<4, 128>::mount(&cells, 640);
    Store::open(slots, buffer, accept).map(|(store, _)| store)
}

#[test]
fn what_can_never_work_is_refused_at_open() {
    let opened = |buffer, joints| open_with(&mut vec![0; buffer], Acceptance::of(1, joints)).err();
    assert_eq!(opened(564, 6), None);
    assert_eq!(opened(563, 6), Some(GeometryError::Buffer { needed: 564, got: 563 }));
    assert_eq!(opened(1024, 7), Some(GeometryError::Slot { needed: 640, room: 624 }));
    assert_eq!(opened(1024, 0), Some(GeometryError::Joints(0)));
    assert_eq!(opened(4096, 17), Some(GeometryError::Joints(17)));
    let blob = short(6, 24, 1, 1);
    let mut store = open_with(&mut [0; 1024], mine()).expect("room for six joints");
    let long = WriteError::TooLong { needed: blob.len(), room: 624 };
    assert_eq!(store.store(&blob), Err(StoreError::Write(long)));
}

/// The last number is not stored, so that there is always one to come.
#[test]
fn no_sequence_number_blocks_the_next() {
    let cells = flash();
    let refused = StoreError::Blob(AcceptanceError::LastSequence);
    assert_eq!(store(&cells, &full(u32::MAX, 1)), Err(refused));
    assert_eq!(store(&cells, &full(5, 1)), Ok(Stored::Written(Slot::A)));
    assert_eq!(store(&cells, &full(u32::MAX, 2)), Err(refused));
    assert_eq!(store(&cells, &full(6, 2)), Ok(Stored::Written(Slot::B)));
}

/// A bus that does not answer for a moment is no damage.
#[test]
fn a_fault_erases_nothing() {
    let blob = full(5, 1);
    for failing in 0..12 {
        let cells = flash();
        store_without_end(&cells, &blob, Slot::A);
        cells.borrow_mut().power_up(None);
        cells.borrow_mut().fail_read(failing);
        let mut buffer = [0; SLOT];
        let slots = Flash::mount(&cells, SLOT);
        Store::open(slots, &mut buffer, mine()).expect("room for a blob");
        let (_, opened) = open(&cells, &mut buffer);
        assert_eq!(opened.blob, Blob::check(&blob).ok(), "read {failing}");
    }
}

#[test]
fn what_is_in_use_is_not_discarded() {
    let cells = flash();
    fresh(&cells, &full(5, 1));
    let mut buffer = [0; SLOT];
    let (mut store, _) = open(&cells, &mut buffer);
    assert_eq!(store.discard(Slot::A), Err(StoreError::InUse(Slot::A)));
    assert_eq!(source(&cells), Source::Newest(Slot::A));
}

/// Another robot's blob in the only other slot: an unfinished store is then
/// written anew in place, which may lose it again, but not a blob that a
/// power-up had returned for good.
#[test]
fn an_unfinished_store_beside_another_robots_blob_is_ended_in_place() {
    let cells = flash();
    cells.borrow_mut().flash(0, &another_robots(9), SLOT);
    let before = slot(&cells, Slot::A);
    store_without_end(&cells, &full(5, 1), Slot::B);
    // The programmer wrote what a store would have: the words are erased first.
    for at in [None, Some(0), Some(30)] {
        cells.borrow_mut().power_up(at.map(|at| Cut { at, tear: Tear::Part }));
        let mut buffer = [0; SLOT];
        let slots = Flash::mount(&cells, SLOT);
        let (_, opened) = Store::open(slots, &mut buffer, mine()).expect("room for a blob");
        if at.is_none() {
            assert_eq!(opened.settled, Settled::Rewritten);
            assert_eq!(opened.blob, Blob::check(&full(5, 1)).ok());
        }
        assert_eq!(slot(&cells, Slot::A), before);
        store_without_end(&cells, &full(5, 1), Slot::B);
    }
}
