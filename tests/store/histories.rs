//! An attacker's histories: stores and power-ups with power cuts, by the arm's
//! own firmware and by others that expect another robot, another number of
//! joints or have a short buffer, and a programmer who writes what they like.

use std::cell::RefCell;
use std::marker::PhantomData;
use std::rc::Rc;

use proptest::prelude::*;
use truearm::blob::{Acceptance, Blob};
use truearm::store::{Medium, Settled, Slot, Store, StoreError, WriteError};

use super::rig::cells::{Cells, Cut, EccPart, EepromPart, NorPart, Part, Shared, Tear};
use super::rig::samples::{mine, seal, short};

/// A firmware: what it accepts and how long its buffer is.
#[derive(Debug, Clone, Copy)]
enum Firmware {
    /// The arm's, with room for every blob.
    Own,
    /// The arm's, with a buffer for blobs without terms.
    Short,
    /// Of another robot.
    Other,
    /// The arm's id, but two joints.
    TwoJoints,
    /// The arm's, and takes nothing older than what it had before.
    Fresh,
}

#[derive(Debug, Clone, Copy)]
enum Deed {
    /// Open, perhaps store a blob with so many terms, perhaps cut at this
    /// operation.
    Run { by: Firmware, store: Option<usize>, cut: Option<Cut> },
    /// A programmer writes a whole blob that the arm refuses.
    Flash { slot: Slot, what: usize },
    /// The caller discards what is in the way.
    Discard { slot: Slot },
}

fn deed() -> impl Strategy<Value = Deed> {
    let by = prop_oneof![
        6 => Just(Firmware::Own),
        2 => Just(Firmware::Short),
        1 => Just(Firmware::Other),
        1 => Just(Firmware::TwoJoints),
        1 => Just(Firmware::Fresh),
    ];
    let tear = prop::sample::select(Tear::ALL.to_vec());
    let cut = prop::option::of((0..150_usize, tear).prop_map(|(at, tear)| Cut { at, tear }));
    let slot = || prop::sample::select(vec![Slot::A, Slot::B]);
    prop_oneof![
        8 => (by, prop::option::of(0..6_usize), cut)
            .prop_map(|(by, store, cut)| Deed::Run { by, store, cut }),
        1 => (slot(), 0..3_usize).prop_map(|(slot, what)| Deed::Flash { slot, what }),
        1 => slot().prop_map(|slot| Deed::Discard { slot }),
    ]
}

/// The arm's: one joint.
fn own(terms: usize, sequence: u32) -> Vec<u8> {
    short(1, terms, sequence, sequence as u8)
}

fn others(sequence: u32) -> Vec<u8> {
    let mut blob = own(1, sequence);
    blob[16] ^= 1;
    seal(&mut blob);
    blob
}

fn newer(sequence: u32) -> Vec<u8> {
    let mut blob = own(2, sequence);
    blob[4] = 4;
    seal(&mut blob);
    blob
}

/// What the arm must never lose, and what must never be touched.
struct Watch<P> {
    cells: Shared,
    slot_size: usize,
    /// Of the last blob made.
    sequence: u32,
    /// What the arm's own firmware may find; the last is the newest.
    allowed: Vec<Option<Vec<u8>>>,
    part: PhantomData<P>,
}

impl<P: Part> Watch<P> {
    const MARK: usize = if P::Slots::WORD > 8 { P::Slots::WORD } else { 8 };

    fn new() -> Self {
        // As long as the longest, that of two joints.
        let longest = own(6, 1).len().max(short(2, 0, 1, 1).len());
        let longest = longest.next_multiple_of(Self::MARK);
        let slot_size = (longest + 2 * Self::MARK).next_multiple_of(P::BLOCK);
        let cells = Rc::new(RefCell::new(Cells::blank(2 * slot_size)));
        Self { cells, slot_size, sequence: 0, allowed: vec![None], part: PhantomData }
    }

    fn slots(&self) -> [Vec<u8>; 2] {
        let cells = self.cells.borrow();
        let (a, b) = cells.bytes.split_at(self.slot_size);
        [a.to_vec(), b.to_vec()]
    }

    /// Contents of the slots with a whole, steady blob that this firmware
    /// refuses, but not for its age.
    fn foreign(&self, by: Firmware) -> [Option<Vec<u8>>; 2] {
        let (accept, buffer) = self.contract(by);
        let accept = accept.not_before(0);
        let longest = buffer.min(self.slot_size - 2 * Self::MARK);
        let mut start = 0;
        self.slots().map(|bytes| {
            let steady = self.cells.borrow().is_steady(start, self.slot_size);
            start += self.slot_size;
            let size = u32::from_le_bytes(bytes[8..12].try_into().expect("4 bytes")) as usize;
            let blob = bytes.get(..size).filter(|b| b.starts_with(b"TARM") && b.len() >= 16)?;
            let (body, checksum) = blob.split_last_chunk::<4>().expect("16 bytes");
            let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(body);
            let whole = crc.to_le_bytes() == *checksum;
            let taken = accept.check(blob).is_ok() && size <= longest;
            (whole && steady && !taken).then(|| bytes.clone())
        })
    }

    /// What it accepts, and the bytes of its buffer.
    fn contract(&self, by: Firmware) -> (Acceptance, usize) {
        let accept = mine(&own(0, 1));
        match by {
            Firmware::Own => (accept, self.slot_size),
            Firmware::Short => (accept, own(0, 1).len().next_multiple_of(P::Slots::WORD)),
            Firmware::Other => (mine(&others(1)), self.slot_size),
            Firmware::TwoJoints => (mine(&short(2, 0, 1, 1)), self.slot_size),
            Firmware::Fresh => {
                let had = self.allowed.iter().flatten().map(|b| sequence(b)).min();
                (accept.not_before(had.unwrap_or(0)), self.slot_size)
            }
        }
    }

    fn done(&mut self, deed: Deed) {
        match deed {
            Deed::Run { by, store, cut } => {
                let before = self.foreign(by);
                self.run(by, store, cut);
                for (before, after) in before.into_iter().zip(self.slots()) {
                    assert!(before.is_none_or(|before| before == after), "{deed:?} erased it");
                }
            }
            Deed::Flash { slot, what } if self.spares(slot) => {
                self.sequence += 1;
                let n = self.sequence;
                let blob = vec![others(n), newer(n), own(1, u32::MAX)].swap_remove(what);
                let start = if slot == Slot::A { 0 } else { self.slot_size };
                self.cells.borrow_mut().flash(start, &blob, self.slot_size);
            }
            Deed::Flash { .. } => (),
            Deed::Discard { slot } => {
                let mut buffer = vec![0; self.slot_size];
                let Some(mut store) = self.open(Firmware::Own, None, &mut buffer) else { return };
                let spared = store.live().is_none_or(|(live, _)| live != slot);
                assert_eq!(store.discard(slot).is_ok(), spared);
            }
        }
    }

    /// Whether the arm has its parameters, if any, in the other slot.
    fn spares(&mut self, slot: Slot) -> bool {
        let mut buffer = vec![0; self.slot_size];
        let store = self.open(Firmware::Own, None, &mut buffer);
        let live = store.expect("power").live();
        self.allowed.len() == 1 && live.is_none_or(|(live, _)| live != slot)
    }

    fn run(&mut self, by: Firmware, terms: Option<usize>, cut: Option<Cut>) {
        let mut buffer = vec![0; self.slot_size];
        let Some(mut store) = self.open(by, cut, &mut buffer) else { return };
        let Some(terms) = terms else { return };
        self.sequence += 1;
        let n = self.sequence;
        let (blob, is_own) = match by {
            Firmware::Own | Firmware::Short | Firmware::Fresh => (own(terms, n), true),
            Firmware::Other => (others(n), false),
            Firmware::TwoJoints => (short(2, 0, n, n as u8), false),
        };
        let stored = store.store(&blob);
        match stored {
            Ok(_) if is_own => self.allowed = vec![Some(blob)],
            Err(_) if self.cells.borrow().dead && is_own => self.allowed.push(Some(blob)),
            Ok(_) => (),
            Err(_) if self.cells.borrow().dead => (),
            Err(
                StoreError::Unsettled
                | StoreError::Write(WriteError::Occupied(_) | WriteError::TooLong { .. }),
            ) => (),
            Err(error) => panic!("{error}"),
        }
        if stored.is_ok() {
            // The next power-up of the same firmware finds just that.
            let mut buffer = vec![0; self.slot_size];
            let store = self.open(by, None, &mut buffer).expect("power");
            assert_eq!(store.live().map(|(_, sequence)| sequence), Some(n));
        }
    }

    /// Opens, and holds what is found against what may be; `None` without power.
    fn open(
        &mut self,
        by: Firmware,
        cut: Option<Cut>,
        buffer: &mut [u8],
    ) -> Option<Store<P::Slots>> {
        self.cells.borrow_mut().power_up(cut);
        let (accept, size) = self.contract(by);
        let slots = P::mount(&self.cells, self.slot_size);
        let opened = Store::open(slots, &mut buffer[..size], accept);
        let (store, opened) = opened.expect("room for the blobs");
        if self.cells.borrow().dead {
            return None;
        }
        let found = opened.blob.map(|blob| bytes_of(&blob));
        let final_one = !matches!(opened.settled, Settled::Failed(_));
        match by {
            Firmware::Own | Firmware::Fresh => {
                let may_be = self.allowed.contains(&found);
                assert!(may_be, "{by:?} found {found:?} where {:?} may be", self.allowed);
                if final_one {
                    self.allowed = vec![found];
                }
            }
            // It sees the short ones only, but what it returns is as final.
            Firmware::Short => {
                if final_one && found.is_some() && self.allowed.last() == Some(&found) {
                    self.allowed = vec![found];
                }
            }
            Firmware::Other | Firmware::TwoJoints => (),
        }
        Some(store)
    }
}

fn sequence(blob: &[u8]) -> u32 {
    Blob::check(blob).expect("a blob").sequence()
}

/// As it was made, from its number and its terms.
fn bytes_of(blob: &Blob) -> Vec<u8> {
    let made = match (blob.joints(), blob.robot_id() == sample_robot()) {
        (1, true) => own(blob.terms(), blob.sequence()),
        (1, false) => others(blob.sequence()),
        _ => short(2, 0, blob.sequence(), blob.sequence() as u8),
    };
    assert_eq!(Blob::check(&made).as_ref(), Ok(blob), "a mixture of blobs");
    made
}

fn sample_robot() -> u64 {
    Blob::check(&own(0, 1)).expect("a blob").robot_id()
}

fn holds<P: Part>(deeds: &[Deed], seed: u64) {
    let mut watch = Watch::<P>::new();
    watch.cells.borrow_mut().seed(seed);
    deeds.iter().for_each(|deed| watch.done(*deed));
    watch.done(Deed::Run { by: Firmware::Own, store: None, cut: None });
}

proptest! {
    #[test]
    fn no_history_loses_or_erases_what_it_should_not(
        deeds in prop::collection::vec(deed(), 1..30),
        seed: u64,
    ) {
        holds::<NorPart<1, 64>>(&deeds, seed);
        holds::<NorPart<8, 512>>(&deeds, seed);
        holds::<NorPart<32, 256>>(&deeds, seed);
        holds::<EepromPart<32>>(&deeds, seed);
        holds::<EccPart<16, 512>>(&deeds, seed);
    }
}
