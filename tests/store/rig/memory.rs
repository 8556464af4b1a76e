//! Memory that loses its power at a chosen operation, has worn cells, and may
//! have an ECC.

use std::cell::RefCell;
use std::rc::Rc;

use embedded_storage::nor_flash::NorFlashErrorKind;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

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

/// The bytes, their bits that read differently from time to time, and the power.
#[derive(Debug, Clone)]
pub struct Cells {
    pub bytes: Vec<u8>,
    floating: Vec<u8>,
    /// Whether any bit ever did.
    unsteady: bool,
    /// Of each byte, whether it may not be programmed before it is erased.
    written: Vec<bool>,
    dice: ChaCha8Rng,
    cut: Option<Cut>,
    /// Operations since the power came on.
    pub operations: usize,
    pub dead: bool,
    /// Readings until some fail, and how many.
    until_fault: usize,
    faults: usize,
    /// Bytes of a word with an ECC, 0 without: it mends one wrong bit, with more
    /// the word cannot be read.
    pub ecc: usize,
    /// What the ECC was made of, of a word that was cut either of two.
    codes: [Vec<u8>; 2],
    /// Byte, bits of it and what they are stuck at.
    pub worn: Option<Worn>,
}

/// Bits of a byte that do not change any more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Worn {
    pub byte: usize,
    pub bits: u8,
    pub one: bool,
}

impl Cells {
    pub fn blank(size: usize) -> Self {
        Self {
            bytes: vec![0xff; size],
            floating: vec![0; size],
            unsteady: false,
            written: vec![false; size],
            dice: ChaCha8Rng::seed_from_u64(0),
            cut: None,
            operations: 0,
            dead: false,
            until_fault: 0,
            faults: 0,
            ecc: 0,
            codes: [vec![0xff; size], vec![0xff; size]],
            worn: None,
        }
    }

    /// The power comes on.
    pub fn power_up(&mut self, cut: Option<Cut>) {
        self.cut = cut;
        self.operations = 0;
        self.dead = false;
        self.faults = 0;
    }

    /// Whether no bit of these bytes reads differently from time to time.
    pub fn is_steady(&self, start: usize, size: usize) -> bool {
        self.floating[start..][..size].iter().all(|bits| *bits == 0)
    }

    /// Readings that fail after so many that do not.
    pub fn fail_reads(&mut self, after: usize, count: usize) {
        (self.until_fault, self.faults) = (after, count);
    }

    pub fn seed(&mut self, seed: u64) {
        self.dice = ChaCha8Rng::seed_from_u64(seed);
    }

    /// What a programmer does from outside.
    pub fn flash(&mut self, start: usize, bytes: &[u8], slot_size: usize) {
        let slot = start..start + slot_size;
        self.bytes[slot.clone()].fill(0xff);
        self.floating[slot.clone()].fill(0);
        self.written[slot].fill(true);
        self.bytes[start..start + bytes.len()].copy_from_slice(bytes);
        for code in &mut self.codes {
            code[start..start + slot_size].copy_from_slice(&self.bytes[start..][..slot_size]);
        }
    }

    /// Words of a flash are erased before they are written again.
    pub fn write_once(&mut self, start: usize, size: usize) {
        let written = &mut self.written[start..start + size];
        assert!(written.iter().all(|w| !w), "word at {start} not erased since written");
        written.fill(true);
    }

    pub fn may_be_written(&mut self, start: usize, size: usize) {
        self.written[start..start + size].fill(false);
    }

    pub fn read(&mut self, start: usize, out: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        if self.dead {
            return Err(NorFlashErrorKind::Other);
        }
        match self.until_fault.checked_sub(1) {
            Some(until) => self.until_fault = until,
            None if self.faults > 0 => {
                self.faults -= 1;
                return Err(NorFlashErrorKind::Other);
            }
            None => (),
        }
        if !self.unsteady && self.ecc == 0 && self.worn.is_none() {
            out.copy_from_slice(&self.bytes[start..][..out.len()]);
            return Ok(());
        }
        let cells = self.bytes[start..].iter().zip(&self.floating[start..]);
        for (to, (byte, floating)) in out.iter_mut().zip(cells) {
            let noise = if *floating == 0 { 0 } else { self.dice.random::<u8>() };
            *to = byte ^ (noise & floating);
        }
        if let Some(Worn { byte, bits, one }) = self.worn
            && let Some(byte) = byte.checked_sub(start).and_then(|at| out.get_mut(at))
        {
            *byte = if one { *byte | bits } else { *byte & !bits };
        }
        self.correct(start, out)
    }

    /// Words as an ECC of one bit reads them. Of random words a quarter look as if
    /// they had one wrong bit.
    fn correct(&self, start: usize, out: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        if self.ecc == 0 {
            return Ok(());
        }
        for (word, start) in out.chunks_mut(self.ecc).zip((start..).step_by(self.ecc)) {
            let mut codes = self.codes.iter().map(|code| &code[start..start + word.len()]);
            let code = codes.find(|code| {
                word.iter().zip(*code).map(|(a, b)| (a ^ b).count_ones()).sum::<u32>() <= 1
            });
            let sum = word.iter().fold(0, |sum: u8, byte| sum.rotate_left(3) ^ byte);
            match code {
                Some(code) => word.copy_from_slice(code),
                None if sum % 4 == 0 => (),
                None => return Err(NorFlashErrorKind::Other),
            }
        }
        Ok(())
    }

    /// One operation: these bytes become `new`.
    pub fn change(&mut self, start: usize, new: &[u8]) -> Result<(), NorFlashErrorKind> {
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
        self.codes.iter_mut().for_each(|code| code[start..start + new.len()].copy_from_slice(new));
    }

    fn tear(&mut self, start: usize, new: &[u8], tear: Tear) {
        self.unsteady |= matches!(tear, Tear::Floating | Tear::Weak | Tear::Disturbed);
        let old = self.bytes[start..start + new.len()].to_vec();
        if tear != Tear::Not {
            self.codes[0][start..start + new.len()].copy_from_slice(new);
        }
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
