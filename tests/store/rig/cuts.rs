//! The power fails at every operation of a store, again at every operation of
//! what follows, and after each the promises of `truearm::store` are held.

use std::cell::RefCell;
use std::marker::PhantomData;
use std::rc::Rc;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::{Acceptance, Blob};
use truearm::store::{self, Medium, Store};

use super::cells::{Cells, Cut, Part, Shared, Tear};
use super::samples;

/// What stands in the slots before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// Nothing.
    Empty,
    /// One blob that a programmer wrote to slot A.
    Programmed,
    /// One stored blob.
    Stored,
    /// Two stored blobs.
    StoredTwice,
    /// A stored one, and a newer one that a programmer wrote to the other slot.
    ProgrammedOver,
}

impl Start {
    pub const ALL: [Self; 5] =
        [Self::Empty, Self::Programmed, Self::Stored, Self::StoredTwice, Self::ProgrammedOver];
}

fn shared(cells: Cells) -> Shared {
    Rc::new(RefCell::new(cells))
}

/// Blobs by sequence number from 1 on.
pub struct Blobs(Vec<Vec<u8>>);

impl Blobs {
    /// Of one joint, with nine terms or none.
    pub fn small(count: u32) -> Self {
        let terms = |sequence| if sequence % 4 < 2 { 9 } else { 0 };
        Self((1..=count).map(|n| samples::short(1, terms(n), n, n as u8)).collect())
    }

    /// Of six joints.
    pub fn full(count: u32) -> Self {
        Self((1..=count).map(|n| samples::full(n, n as u8)).collect())
    }

    fn mine(&self) -> Acceptance {
        samples::mine(self.get(1))
    }

    fn get(&self, sequence: u32) -> &[u8] {
        &self.0[sequence as usize - 1]
    }
}

/// Cuts tried, and what they were.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Tally {
    /// Power cuts.
    pub cuts: u64,
    /// Runs of one cut.
    pub single: u64,
    /// Runs of two cuts.
    pub double: u64,
}

impl std::ops::Add for Tally {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            cuts: self.cuts + other.cuts,
            single: self.single + other.single,
            double: self.double + other.double,
        }
    }
}

/// Says which run it was that panicked.
#[derive(Debug)]
#[expect(dead_code, reason = "for the eyes of a developer")]
struct Tell {
    part: &'static str,
    from: Start,
    first: Cut,
    second: Option<Cut>,
    next: u32,
}

impl Drop for Tell {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("in the run {self:?}");
        }
    }
}

/// All cuts of one part from one start.
pub struct Bench<P> {
    blobs: Blobs,
    from: Start,
    start: Cells,
    /// Sequence numbers of the blobs that may be found at the start.
    old: Vec<Option<u32>>,
    slot_size: usize,
    part: PhantomData<P>,
}

impl<P: Part> Bench<P> {
    pub fn new(start: Start, blobs: Blobs) -> Self {
        let longest = blobs.0.iter().map(Vec::len).max().unwrap_or(0);
        let mark = <P::Slots as Medium>::WORD.max(8);
        let slot_size = (longest.next_multiple_of(mark) + 2 * mark).next_multiple_of(P::BLOCK);
        let cells = Cells::blank(2 * slot_size);
        let mut bench = Self {
            blobs,
            from: start,
            start: cells,
            old: vec![None],
            slot_size,
            part: PhantomData,
        };
        match start {
            Start::Empty => (),
            Start::Programmed => bench.program(0, 2),
            Start::Stored => bench.prepare(2),
            Start::StoredTwice => [1, 2].into_iter().for_each(|sequence| bench.prepare(sequence)),
            Start::ProgrammedOver => {
                bench.prepare(1);
                bench.program(1, 2);
            }
        }
        bench
    }

    fn program(&mut self, slot: usize, sequence: u32) {
        self.start.flash(slot * self.slot_size, self.blobs.get(sequence), self.slot_size);
        self.old = vec![Some(sequence)];
    }

    fn prepare(&mut self, sequence: u32) {
        let cells = shared(self.start.clone());
        let mut allowed = self.old.clone();
        self.session(&cells, None, Some(sequence), &mut allowed);
        (self.start, self.old) = (cells.borrow().clone(), allowed);
    }

    /// Power-ups and stores in any order, from the start.
    pub fn history(&self, seed: u64) -> History<'_, P> {
        let cells = shared(self.start.clone());
        cells.borrow_mut().seed(seed);
        History { bench: self, cells, allowed: self.old.clone(), next: 3 }
    }

    /// Whatever `damage` flips in the memory, a power-up finds a blob of this
    /// robot or none, a store writes, and the next power-up finds what it wrote
    /// and need not write it again.
    pub fn damaged(&self, from: usize, damage: &[u8]) {
        let mut cells = self.start.clone();
        for (byte, flips) in cells.bytes.iter_mut().skip(from).zip(damage) {
            *byte ^= flips;
        }
        let cells = shared(cells);
        let newest = self.blobs.0.last().expect("blobs");
        for found in [None, Some(Blob::check(newest))] {
            cells.borrow_mut().power_up(None);
            let mut buffer = vec![0; self.slot_size];
            let slots = P::mount(&cells, self.slot_size);
            let (mut store, opened) =
                Store::open(slots, &mut buffer, self.blobs.mine()).expect("room for the blobs");
            if let Some(found) = found {
                assert_eq!(opened.blob, found.ok());
            } else if let Some(blob) = opened.blob {
                assert_eq!(self.blobs.mine().judge(&blob), Ok(()));
            }
            let stored = store.store(newest).expect("a newer blob than any");
            let written = matches!(stored, store::Stored::Written(_));
            assert_eq!(written, opened.blob != Blob::check(newest).ok(), "{stored:?}");
        }
    }

    /// Operations of an uncut open and store.
    pub fn operations(&self) -> usize {
        let cells = shared(self.start.clone());
        self.session(&cells, None, Some(3), &mut self.old.clone());
        cells.borrow().operations
    }

    /// Cuts the first store at operation `at` in every way, alone and followed
    /// by second cuts of the next power-up and store: of every operation in
    /// every way, or of a sample that `seed` draws.
    pub fn cut_at(&self, at: usize, sample: Option<usize>, seed: u64) -> Tally {
        let mut dice = ChaCha8Rng::seed_from_u64(seed ^ (at as u64) << 32);
        let mut tally = Tally::default();
        for tear in Tear::ALL {
            let first = Cut { at, tear };
            for next in [3, 4] {
                let torn_seed = dice.random();
                let operations = self.run(first, None, next, torn_seed);
                tally = tally + Tally { cuts: 1, single: 1, double: 0 };
                let all = (0..operations).flat_map(|at| Tear::ALL.map(|tear| Cut { at, tear }));
                let seconds: Vec<Cut> = match sample {
                    None => all.collect(),
                    Some(count) => (0..count)
                        .map(|_| Cut {
                            at: dice.random_range(0..operations.max(1)),
                            tear: Tear::ALL[dice.random_range(0..Tear::ALL.len())],
                        })
                        .collect(),
                };
                for second in seconds {
                    self.run(first, Some(second), next, torn_seed);
                    tally = tally + Tally { cuts: 2, single: 0, double: 1 };
                }
            }
        }
        tally
    }

    /// A store of 3 that is cut, a power-up with a store of `next` that may be
    /// cut too, and power-ups that must all tell the same; then a whole store.
    /// Returns the operations of the second power-up and store.
    fn run(&self, first: Cut, second: Option<Cut>, next: u32, seed: u64) -> usize {
        let _tell = Tell { part: P::NAME, from: self.from, first, second, next };
        let cells = shared(self.start.clone());
        cells.borrow_mut().seed(seed);
        let mut allowed = self.old.clone();
        self.session(&cells, Some(first), Some(3), &mut allowed);
        self.session(&cells, second, Some(next), &mut allowed);
        let operations = cells.borrow().operations;
        for _ in 0..3 {
            self.session(&cells, None, None, &mut allowed);
        }
        self.session(&cells, None, Some(4), &mut allowed);
        assert_eq!(allowed, [Some(4)], "a whole store");
        self.session(&cells, None, None, &mut allowed);
        operations
    }

    /// One power-up, with a store unless `sequence` is none or stored already.
    /// `allowed`: what may be found; what was returned, until a store begins.
    fn session(
        &self,
        cells: &Shared,
        cut: Option<Cut>,
        sequence: Option<u32>,
        allowed: &mut Vec<Option<u32>>,
    ) {
        cells.borrow_mut().power_up(cut);
        let mut buffer = vec![0; self.slot_size];
        let slots = P::mount(cells, self.slot_size);
        let (mut store, opened) =
            Store::open(slots, &mut buffer, self.blobs.mine()).expect("room for the blobs");
        // A machine without power tells nobody what it found.
        let alive = !cells.borrow().dead;
        if alive {
            let found = opened.blob.map(|blob| {
                let sequence = blob.sequence();
                assert_eq!(Ok(blob), Blob::check(self.blobs.get(sequence)), "a mixture of blobs");
                sequence
            });
            assert!(allowed.contains(&found), "found {found:?} where {allowed:?} may be");
            *allowed = vec![found];
        }
        if let (Some(sequence), true) = (sequence, alive) {
            if !allowed.contains(&Some(sequence)) {
                allowed.push(Some(sequence));
            }
            match store.store(self.blobs.get(sequence)) {
                Ok(_) => *allowed = vec![Some(sequence)],
                Err(error) => assert!(cells.borrow().dead, "{error}"),
            }
        }
    }
}

/// Power-ups, stores and power cuts, one after the other.
pub struct History<'b, P> {
    bench: &'b Bench<P>,
    cells: Shared,
    allowed: Vec<Option<u32>>,
    next: u32,
}

impl<P: Part> History<'_, P> {
    /// A power-up, perhaps with a store of the next blob, perhaps cut.
    pub fn power_up(&mut self, cut: Option<Cut>, store: bool) {
        let sequence = store.then_some(self.next);
        self.next += u32::from(store);
        self.bench.session(&self.cells, cut, sequence, &mut self.allowed);
    }
}
