//! Memory that loses its power at a chosen operation, as flash or as EEPROM.

use std::cell::RefCell;
use std::rc::Rc;

use embedded_storage::nor_flash::{self, NorFlash, NorFlashErrorKind, ReadNorFlash};
use embedded_storage::{ReadStorage, Storage};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::store::{ByteSlots, EccNor, Medium, NorSlots};

/// How an operation looks that the power cut short.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tear {
    /// As if it had not begun.
    Not,
    /// Every bit old or new.
    Part,
    /// Any bytes.
    Random,
    /// New up to some byte, then old; in a word also the other way round.
    Half,
    /// Every bit that was to change reads differently from time to time.
    Floating,
    /// New, but for up to two bits that read differently from time to time.
    Weak,
    /// Old, but for up to two such bits.
    Disturbed,
    /// Complete; the power fails right after.
    Done,
}

impl Tear {
    pub const ALL: [Self; 8] = [
        Self::Not,
        Self::Part,
        Self::Random,
        Self::Half,
        Self::Floating,
        Self::Weak,
        Self::Disturbed,
        Self::Done,
    ];
}

/// The power fails at this operation (programming a word, erasing a block),
/// counted from 0, in this way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cut {
    pub at: usize,
    pub tear: Tear,
}

/// Cells of a part and its driver, which both look at them.
pub type Shared = Rc<RefCell<Cells>>;

/// What an error-correcting code says of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Torn {
    /// Nothing: it was not cut, or what it holds has the right code.
    No,
    /// That it is lost, at every reading.
    Lost,
    /// The same, at some readings.
    Unsteady,
}

/// The bytes, their bits that read differently from time to time, and the power.
#[derive(Debug, Clone)]
pub struct Cells {
    pub bytes: Vec<u8>,
    floating: Vec<u8>,
    /// Whether any bit ever did.
    unsteady: bool,
    /// What the error-correcting code of a word makes of a cut, at its first byte.
    torn: Vec<Torn>,
    /// Of each byte, whether it may not be programmed before it is erased.
    written: Vec<bool>,
    dice: ChaCha8Rng,
    cut: Option<Cut>,
    /// Operations since the power came on.
    pub operations: usize,
    pub dead: bool,
    /// Readings until one fails.
    until_fault: Option<usize>,
}

impl Cells {
    pub fn blank(size: usize) -> Self {
        Self {
            bytes: vec![0xff; size],
            floating: vec![0; size],
            unsteady: false,
            torn: vec![Torn::No; size],
            written: vec![false; size],
            dice: ChaCha8Rng::seed_from_u64(0),
            cut: None,
            operations: 0,
            dead: false,
            until_fault: None,
        }
    }

    /// The power comes on.
    pub fn power_up(&mut self, cut: Option<Cut>) {
        self.cut = cut;
        self.operations = 0;
        self.dead = false;
        self.until_fault = None;
    }

    /// Whether no bit of these bytes reads differently from time to time.
    pub fn is_steady(&self, start: usize, size: usize) -> bool {
        self.floating[start..][..size].iter().all(|bits| *bits == 0)
    }

    /// One reading fails after so many that do not.
    pub fn fail_read(&mut self, after: usize) {
        self.until_fault = Some(after);
    }

    pub fn seed(&mut self, seed: u64) {
        self.dice = ChaCha8Rng::seed_from_u64(seed);
    }

    /// What a programmer does from outside.
    pub fn flash(&mut self, start: usize, bytes: &[u8], slot_size: usize) {
        let slot = start..start + slot_size;
        self.bytes[slot.clone()].fill(0xff);
        self.floating[slot.clone()].fill(0);
        self.torn[slot.clone()].fill(Torn::No);
        self.written[slot].fill(true);
        self.bytes[start..start + bytes.len()].copy_from_slice(bytes);
    }

    fn read(&mut self, start: usize, out: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        if self.dead {
            return Err(NorFlashErrorKind::Other);
        }
        let until = self.until_fault;
        self.until_fault = until.and_then(|n| n.checked_sub(1));
        if until == Some(0) {
            return Err(NorFlashErrorKind::Other);
        }
        if !self.unsteady {
            out.copy_from_slice(&self.bytes[start..][..out.len()]);
            return Ok(());
        }
        let cells = self.bytes[start..].iter().zip(&self.floating[start..]);
        for (to, (byte, floating)) in out.iter_mut().zip(cells) {
            let noise = if *floating == 0 { 0 } else { self.dice.random::<u8>() };
            *to = byte ^ (noise & floating);
        }
        Ok(())
    }

    /// One operation: these bytes become `new`.
    fn change(&mut self, start: usize, new: &[u8]) -> Result<(), NorFlashErrorKind> {
        if self.dead {
            return Err(NorFlashErrorKind::Other);
        }
        let tear = match self.cut {
            Some(cut) if cut.at == self.operations => Some(cut.tear),
            _ => None,
        };
        self.operations += 1;
        match tear {
            None => self.set(start, new),
            Some(tear) => {
                self.dead = true;
                self.tear(start, new, tear);
                return Err(NorFlashErrorKind::Other);
            }
        }
        Ok(())
    }

    fn set(&mut self, start: usize, new: &[u8]) {
        self.bytes[start..start + new.len()].copy_from_slice(new);
        self.floating[start..start + new.len()].fill(0);
        self.torn[start..start + new.len()].fill(Torn::No);
    }

    /// Whether the code of the word at `start` gives it up now.
    fn is_lost(&mut self, start: usize) -> bool {
        match self.torn[start] {
            Torn::No => false,
            Torn::Lost => true,
            Torn::Unsteady => self.dice.random(),
        }
    }

    fn tear(&mut self, start: usize, new: &[u8], tear: Tear) {
        self.unsteady |= matches!(tear, Tear::Floating | Tear::Weak | Tear::Disturbed);
        let old = self.bytes[start..start + new.len()].to_vec();
        let middle = self.dice.random_range(0..=new.len());
        // An erase block, longer than any word here, is not erased from its end.
        let swapped = new.len() <= 32 && self.dice.random::<bool>();
        let bytes = self.bytes[start..].iter_mut().zip(&mut self.floating[start..]);
        for (index, ((byte, floating), (old, new))) in bytes.zip(old.iter().zip(new)).enumerate() {
            let random = self.dice.random::<u8>();
            match tear {
                Tear::Not => (),
                Tear::Part => *byte = (old & random) | (new & !random),
                Tear::Random => *byte = random,
                Tear::Half => *byte = if (index < middle) == swapped { *old } else { *new },
                Tear::Floating => *floating |= old ^ new,
                Tear::Weak | Tear::Done => (*byte, *floating) = (*new, 0),
                Tear::Disturbed => *byte = *old,
            }
        }
        if !matches!(tear, Tear::Not | Tear::Done) {
            for torn in &mut self.torn[start..][..new.len()] {
                *torn = [Torn::No, Torn::Lost, Torn::Unsteady][self.dice.random_range(0..3)];
            }
        }
        if matches!(tear, Tear::Weak | Tear::Disturbed) {
            // In a long block the first word is where it hurts.
            let reach = new.len().min(8);
            for _ in 0..2 {
                let bit = 1 << self.dice.random_range(0..8);
                self.floating[start + self.dice.random_range(0..reach)] |= bit;
            }
        }
    }
}

/// NOR flash with words of `W` bytes and erase blocks of `E`.
#[derive(Debug)]
pub struct Nor<const W: usize, const E: usize>(Shared);

impl<const W: usize, const E: usize> Nor<W, E> {
    pub fn new(cells: &Shared) -> Self {
        Self(Rc::clone(cells))
    }
}

impl<const W: usize, const E: usize> nor_flash::ErrorType for Nor<W, E> {
    type Error = NorFlashErrorKind;
}

impl<const W: usize, const E: usize> ReadNorFlash for Nor<W, E> {
    const READ_SIZE: usize = if W < 4 { 1 } else { 4 };

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        nor_flash::check_read(self, offset, bytes.len())?;
        self.0.borrow_mut().read(offset as usize, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.borrow().bytes.len()
    }
}

impl<const W: usize, const E: usize> NorFlash for Nor<W, E> {
    const WRITE_SIZE: usize = W;
    const ERASE_SIZE: usize = E;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        nor_flash::check_erase(self, from, to)?;
        for start in (from as usize..to as usize).step_by(E) {
            let cells = &mut self.0.borrow_mut();
            cells.change(start, &[0xff; E])?;
            cells.written[start..start + E].fill(false);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        nor_flash::check_write(self, offset, bytes.len())?;
        for (word, start) in bytes.chunks(W).zip((offset as usize..).step_by(W)) {
            let cells = &mut self.0.borrow_mut();
            if !cells.dead {
                let written = &mut cells.written[start..start + W];
                assert!(written.iter().all(|w| !w), "word at {start} not erased since written");
                written.fill(true);
            }
            cells.change(start, word)?;
        }
        Ok(())
    }
}

/// The same with an error-correcting code in every word.
#[derive(Debug)]
pub struct Ecc<const W: usize, const E: usize>(Nor<W, E>);

impl<const W: usize, const E: usize> Ecc<W, E> {
    pub fn new(cells: &Shared) -> Self {
        Self(Nor::new(cells))
    }
}

/// What its driver says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EccError {
    /// The word was torn.
    DoubleBit,
    Nor(NorFlashErrorKind),
}

impl EccError {
    pub fn is_double_bit(&self) -> bool {
        *self == Self::DoubleBit
    }
}

impl nor_flash::NorFlashError for EccError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::DoubleBit => NorFlashErrorKind::Other,
            Self::Nor(kind) => *kind,
        }
    }
}

impl<const W: usize, const E: usize> nor_flash::ErrorType for Ecc<W, E> {
    type Error = EccError;
}

impl<const W: usize, const E: usize> ReadNorFlash for Ecc<W, E> {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), EccError> {
        self.0.read(offset, bytes).map_err(EccError::Nor)?;
        let (start, end) = (offset as usize / W * W, offset as usize + bytes.len());
        let cells = &mut self.0.0.borrow_mut();
        match (start..end).step_by(W).any(|word| cells.is_lost(word)) {
            true => Err(EccError::DoubleBit),
            false => Ok(()),
        }
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl<const W: usize, const E: usize> NorFlash for Ecc<W, E> {
    const WRITE_SIZE: usize = W;
    const ERASE_SIZE: usize = E;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), EccError> {
        self.0.erase(from, to).map_err(EccError::Nor)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), EccError> {
        self.0.write(offset, bytes).map_err(EccError::Nor)
    }
}

/// EEPROM with pages of `P` bytes: a page that is cut may change in all bytes.
#[derive(Debug)]
pub struct Eeprom<const P: usize>(Shared);

impl<const P: usize> Eeprom<P> {
    pub fn new(cells: &Shared) -> Self {
        Self(Rc::clone(cells))
    }
}

impl<const P: usize> ReadStorage for Eeprom<P> {
    type Error = NorFlashErrorKind;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.0.borrow_mut().read(offset as usize, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.borrow().bytes.len()
    }
}

impl<const P: usize> Storage for Eeprom<P> {
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let mut offset = offset as usize;
        let mut rest = bytes;
        while !rest.is_empty() {
            let page = offset / P * P;
            let (piece, after) = rest.split_at(rest.len().min(page + P - offset));
            let cells = &mut self.0.borrow_mut();
            let mut whole = cells.bytes[page..page + P].to_vec();
            whole[offset - page..][..piece.len()].copy_from_slice(piece);
            cells.change(page, &whole)?;
            (offset, rest) = (offset + piece.len(), after);
        }
        Ok(())
    }
}

/// A part: memory cells behind a driver behind an adapter.
pub trait Part {
    const NAME: &str;
    /// Bytes of a slot must be a multiple of this.
    const BLOCK: usize;
    type Slots: Medium;
    fn mount(cells: &Shared, slot_size: usize) -> Self::Slots;
}

/// NOR flash of the given word and block size.
#[derive(Debug)]
pub struct NorPart<const W: usize, const E: usize>;

impl<const W: usize, const E: usize> Part for NorPart<W, E> {
    const NAME: &str = match W {
        1 => "NOR, 1-byte words",
        4 => "NOR, 4-byte words",
        8 => "NOR, 8-byte words",
        32 => "NOR, 32-byte words",
        _ => "NOR",
    };
    const BLOCK: usize = E;
    type Slots = NorSlots<Nor<W, E>>;

    fn mount(cells: &Shared, slot_size: usize) -> Self::Slots {
        let size = slot_size as u32;
        NorSlots::new(Nor::new(cells), [0, size], size).expect("a geometry of whole blocks")
    }
}

/// EEPROM of the given page size.
#[derive(Debug)]
pub struct EepromPart<const P: usize>;

impl<const P: usize> Part for EepromPart<P> {
    const NAME: &str = match P {
        8 => "EEPROM, 8-byte pages",
        32 => "EEPROM, 32-byte pages",
        _ => "EEPROM",
    };
    const BLOCK: usize = P;
    type Slots = ByteSlots<Eeprom<P>, P>;

    fn mount(cells: &Shared, slot_size: usize) -> Self::Slots {
        let size = slot_size as u32;
        ByteSlots::new(Eeprom::new(cells), [0, size], size).expect("a geometry of whole pages")
    }
}

/// NOR flash with an error-correcting code in every word, whose torn words are
/// read as zeros.
#[derive(Debug)]
pub struct EccPart<const W: usize, const E: usize>;

impl<const W: usize, const E: usize> Part for EccPart<W, E> {
    const NAME: &str = match W {
        8 => "NOR with ECC, 8-byte words",
        32 => "NOR with ECC, 32-byte words",
        _ => "NOR with ECC",
    };
    const BLOCK: usize = E;
    type Slots = NorSlots<EccNor<Ecc<W, E>, fn(&EccError) -> bool>>;

    fn mount(cells: &Shared, slot_size: usize) -> Self::Slots {
        let size = slot_size as u32;
        let flash: EccNor<_, fn(&EccError) -> bool> =
            EccNor::new(Ecc::new(cells), EccError::is_double_bit);
        NorSlots::new(flash, [0, size], size).expect("a geometry of whole blocks")
    }
}
