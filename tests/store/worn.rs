//! Worn cells in one of the slots, with power cuts: what was in use is not
//! lost, and a healthy slot serves where nothing else could be lost.

use std::cell::RefCell;
use std::marker::PhantomData;
use std::rc::Rc;

use proptest::prelude::*;
use truearm::store::{Medium, Settled, Slot, Store, StoreError, Stored, WriteError};

use super::rig::cells::{Cells, Cut, EccPart, EepromPart, NorPart, Part, Shared, Tear};
use super::rig::memory::Worn;
use super::rig::samples::{Blobs, full};
use super::rules::{Flash, SLOT, flash, mine, store};

/// A device with worn cells in one slot.
struct Device<P> {
    cells: Shared,
    slot_size: usize,
    worn: Slot,
    blobs: Blobs,
    /// What may be found.
    allowed: Vec<Option<u32>>,
    part: PhantomData<P>,
}

impl<P: Part> Device<P> {
    /// Blank, or with a stored blob in the healthy slot; `place` from 0 to 1 in
    /// the slot, its marks as likely as the rest.
    fn new(worn: Slot, place: f64, bits: u8, one: bool, live: bool) -> Self {
        let blobs = Blobs::small(20);
        let longest = blobs.0.iter().map(Vec::len).max().expect("blobs");
        let mark = <P::Slots as Medium>::WORD.max(8);
        let slot_size = (longest.next_multiple_of(mark) + 2 * mark).next_multiple_of(P::BLOCK);
        let cells = Rc::new(RefCell::new(Cells::blank(2 * slot_size)));
        let mut device =
            Self { cells, slot_size, worn, blobs, allowed: vec![None], part: PhantomData };
        if live {
            // To A, or to B after it.
            for sequence in 1..=if worn == Slot::A { 2 } else { 1 } {
                device.power_up(None, Some(sequence));
            }
        }
        let start = if worn == Slot::A { 0 } else { slot_size };
        let at = if place < 0.5 {
            2.0 * place * slot_size as f64
        } else {
            slot_size as f64 - 4.0 * (1.0 - place) * mark as f64
        };
        let byte = start + (at as usize).min(slot_size - 1);
        device.cells.borrow_mut().worn = Some(Worn { byte, bits, one });
        device
    }

    /// The slot in use after a power-up with a store, and whether it succeeded.
    fn power_up(&mut self, cut: Option<Cut>, sequence: Option<u32>) -> (Option<Slot>, bool) {
        self.cells.borrow_mut().power_up(cut);
        let mut buffer = vec![0; self.slot_size];
        let slots = P::mount(&self.cells, self.slot_size);
        let (mut store, opened) =
            Store::open(slots, &mut buffer, self.blobs.mine()).expect("room for the blobs");
        if self.cells.borrow().dead {
            return (None, false);
        }
        let found = opened.blob.map(|blob| blob.sequence());
        assert!(
            self.allowed.contains(&found),
            "{}: found {found:?} of {:?}, {opened:?}",
            P::NAME,
            self.allowed
        );
        let settled = !matches!(opened.settled, Settled::Failed(_));
        if settled {
            self.allowed = vec![found];
        }
        let before = store.live().map(|(slot, _)| slot);
        let Some(sequence) = sequence else { return (before, true) };
        let stored = store.store(self.blobs.get(sequence));
        match stored {
            Ok(_) => self.allowed = vec![Some(sequence)],
            Err(StoreError::Unsettled) => assert!(!settled),
            Err(StoreError::Write(WriteError::Occupied(_))) => assert!(P::ECC),
            // As after a power cut.
            Err(_) => self.allowed.push(Some(sequence)),
        }
        (before, stored.is_ok())
    }

    /// Without a cut the first store on a blank device succeeds, and every one
    /// for which the healthy slot is the one that is not in use.
    fn serves(&mut self) {
        for sequence in 3..12 {
            let (live, stored) = self.power_up(None, Some(sequence));
            assert!(stored || live == Some(self.worn.other()), "{sequence} beside {live:?}");
        }
        assert!(self.power_up(None, None).0.is_some(), "nothing is in use");
    }

    /// After cuts nothing was lost, and what cannot be used still yields.
    fn survives(&mut self, cuts: &[Option<Cut>]) {
        for (cut, sequence) in cuts.iter().zip(3..) {
            self.power_up(*cut, Some(sequence));
        }
        let served = (0..40).any(|_| {
            let (live, stored) = self.power_up(None, Some(19));
            stored || live == Some(self.worn.other())
        });
        assert!(served, "nothing is stored, and the worn slot or none is in use");
        assert!(self.power_up(None, None).0.is_some(), "nothing is in use");
    }
}

fn every_part(run: impl Fn(&dyn Fn(Slot, f64, u8, bool, bool, &[Option<Cut>]))) {
    run(&on::<NorPart<1, 64>>);
    run(&on::<NorPart<4, 128>>);
    run(&on::<NorPart<8, 512>>);
    run(&on::<NorPart<32, 256>>);
    run(&on::<EepromPart<8>>);
    run(&on::<EepromPart<32>>);
    run(&on::<EccPart<8, 512>>);
    run(&on::<EccPart<32, 256>>);
}

fn on<P: Part>(worn: Slot, place: f64, bits: u8, one: bool, live: bool, cuts: &[Option<Cut>]) {
    let mut device = Device::<P>::new(worn, place, bits, one, live);
    if cuts.is_empty() { device.serves() } else { device.survives(cuts) }
}

fn slot() -> impl Strategy<Value = Slot> {
    prop::sample::select(vec![Slot::A, Slot::B])
}

fn bits() -> impl Strategy<Value = u8> {
    prop_oneof![3 => (0..8_u32).prop_map(|bit| 1 << bit), 1 => 1..=u8::MAX]
}

fn cuts() -> impl Strategy<Value = Vec<Option<Cut>>> {
    let tear = prop::sample::select(Tear::ALL.to_vec());
    let cut =
        prop::option::weighted(0.8, (0..250_usize, tear).prop_map(|(at, tear)| Cut { at, tear }));
    prop::collection::vec(cut, 1..10)
}

/// A bus that does not answer for a while, at a power-up, then again at a store,
/// is never taken for a torn word: the newer blob is there again afterwards.
#[test]
fn an_outage_erases_nothing() {
    let cells = flash();
    store(&cells, &full(5, 5)).expect("an empty store");
    store(&cells, &full(6, 6)).expect("a newer blob");
    let whole = cells.borrow().clone();
    let counts = [0, 1, 2, 7, 8, 9, 30, 5000];
    let outages = |from: usize| (0..from).flat_map(move |n| counts.map(|m| (n, m)));
    let mut beside_unread = 0;
    for (first, second) in outages(12).flat_map(|n| outages(16).map(move |m| (n, m))) {
        let cells = Rc::new(RefCell::new(whole.clone()));
        cells.borrow_mut().power_up(None);
        cells.borrow_mut().fail_reads(first.0, first.1);
        let mut buffer = [0; SLOT];
        let slots = Flash::mount(&cells, SLOT);
        let (mut store, _) = Store::open(slots, &mut buffer, mine()).expect("room for a blob");
        beside_unread += usize::from(store.live() == Some((Slot::A, 5)));
        cells.borrow_mut().fail_reads(second.0, second.1);
        let stored = store.store(&full(7, 7)).is_ok();
        let slots = store.release();
        cells.borrow_mut().power_up(None);
        let (store, _) = Store::open(slots, &mut buffer, mine()).expect("room for a blob");
        let found = store.live().map(|(_, sequence)| sequence);
        // What a store began may be found, as after a power cut.
        let may_be = if stored { &[7][..] } else { &[6, 7] };
        assert!(found.is_some_and(|n| may_be.contains(&n)), "{found:?}: {first:?}, {second:?}");
    }
    assert!(beside_unread > 100, "{beside_unread}");
}

/// Where neither slot answers and nothing is in use only the caller knows.
#[test]
fn silent_slots_are_discarded_on_purpose() {
    let cells = flash();
    store(&cells, &full(5, 5)).expect("an empty store");
    cells.borrow_mut().power_up(None);
    cells.borrow_mut().fail_reads(0, usize::MAX);
    let mut buffer = [0; SLOT];
    let slots = Flash::mount(&cells, SLOT);
    let (mut store, _) = Store::open(slots, &mut buffer, mine()).expect("room for a blob");
    let occupied = StoreError::Write(WriteError::Occupied(Slot::B));
    assert_eq!(store.store(&full(6, 6)), Err(occupied));
    assert_eq!(cells.borrow().operations, 0);
    cells.borrow_mut().fail_reads(0, 0);
    assert_eq!(store.discard(Slot::A), Ok(()));
    assert_eq!(store.store(&full(6, 6)), Ok(Stored::Written(Slot::A)));
}

proptest! {
    #[test]
    fn one_healthy_slot_serves(
        worn in slot(), place in 0.0..1.0, bits in bits(), one: bool, live: bool,
    ) {
        every_part(|on| on(worn, place, bits, one, live, &[]));
    }

    #[test]
    fn worn_cells_and_cuts_lose_nothing(
        worn in slot(), place in 0.0..1.0, bits in bits(), one: bool, live: bool, cuts in cuts(),
    ) {
        every_part(|on| on(worn, place, bits, one, live, &cuts));
    }
}
