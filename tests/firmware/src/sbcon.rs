//! I2C by hand over ARM's SBCon: two registers that set and clear the lines.

use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};

/// Where the mps2 boards have their free one.
const BASE: usize = 0x4002_a000;
/// From `BASE`. Write: lines to set. Read: lines as they are.
const SET: usize = 0;
/// From `BASE`. Write: lines to clear.
const CLEAR: usize = 4;

const SCL: u32 = 1;
const SDA: u32 = 2;

/// Clocks of the processor, 25 MHz, for half a bit at 100 kHz.
const HALF_BIT: u32 = 125;

fn register(offset: usize) -> *mut u32 {
    core::ptr::with_exposed_provenance_mut(BASE + offset)
}

/// The board's I2C bus.
#[derive(Debug)]
pub struct SbCon(());

/// A byte that nobody acknowledged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotAcknowledged(NoAcknowledgeSource);

impl Error for NotAcknowledged {
    fn kind(&self) -> ErrorKind {
        ErrorKind::NoAcknowledge(self.0)
    }
}

impl ErrorType for SbCon {
    type Error = NotAcknowledged;
}

impl SbCon {
    /// The bus, idle.
    ///
    /// # Safety
    /// The board is an mps2, and there is one of these.
    pub unsafe fn new() -> Self {
        let mut bus = Self(());
        bus.set(SDA);
        bus.set(SCL);
        // What a reset in the middle of a transfer left: a part that holds SDA
        // lets go after nine clocks.
        for _ in 0..9 {
            bus.read_bit();
        }
        bus.stop();
        bus
    }

    fn set(&mut self, lines: u32) {
        // SAFETY: a register of the board, see `new`.
        unsafe { register(SET).write_volatile(lines) };
        cortex_m::asm::delay(HALF_BIT);
    }

    fn clear(&mut self, lines: u32) {
        // SAFETY: as above.
        unsafe { register(CLEAR).write_volatile(lines) };
        cortex_m::asm::delay(HALF_BIT);
    }

    fn start(&mut self) {
        self.set(SDA);
        self.set(SCL);
        self.clear(SDA);
        self.clear(SCL);
    }

    fn stop(&mut self) {
        self.clear(SDA);
        self.set(SCL);
        self.set(SDA);
    }

    fn write_bit(&mut self, bit: bool) {
        if bit {
            self.set(SDA)
        } else {
            self.clear(SDA)
        }
        self.set(SCL);
        self.clear(SCL);
    }

    fn read_bit(&mut self) -> bool {
        self.set(SDA);
        self.set(SCL);
        // SAFETY: as above.
        let bit = unsafe { register(SET).read_volatile() } & SDA != 0;
        self.clear(SCL);
        bit
    }

    /// Whether it was acknowledged.
    fn write_byte(&mut self, byte: u8) -> bool {
        for bit in (0..8).rev() {
            self.write_bit(byte >> bit & 1 == 1);
        }
        !self.read_bit()
    }

    fn read_byte(&mut self, acknowledge: bool) -> u8 {
        let byte = (0..8).fold(0, |byte, _| byte << 1 | u8::from(self.read_bit()));
        self.write_bit(!acknowledge);
        byte
    }

    fn run(&mut self, address: u8, operations: &mut [Operation]) -> Result<(), NotAcknowledged> {
        let mut reading = None;
        let mut operations = operations.iter_mut().peekable();
        while let Some(operation) = operations.next() {
            let read = matches!(operation, Operation::Read(_));
            if reading != Some(read) {
                reading = Some(read);
                self.start();
                if !self.write_byte(address << 1 | u8::from(read)) {
                    return Err(NotAcknowledged(NoAcknowledgeSource::Address));
                }
            }
            match operation {
                Operation::Read(bytes) => {
                    let more = matches!(operations.peek(), Some(Operation::Read(_)));
                    let last = bytes.len().wrapping_sub(1);
                    for (index, byte) in bytes.iter_mut().enumerate() {
                        *byte = self.read_byte(more || index != last);
                    }
                }
                Operation::Write(bytes) => {
                    if !bytes.iter().all(|byte| self.write_byte(*byte)) {
                        return Err(NotAcknowledged(NoAcknowledgeSource::Data));
                    }
                }
            }
        }
        Ok(())
    }
}

impl I2c for SbCon {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), NotAcknowledged> {
        let result = self.run(address, operations);
        self.stop();
        result
    }
}

/// Waits by counting clocks at 25 MHz.
#[derive(Debug, Clone, Copy)]
pub struct Clocks;

impl DelayNs for Clocks {
    fn delay_ns(&mut self, ns: u32) {
        cortex_m::asm::delay(ns / 40);
    }
}
