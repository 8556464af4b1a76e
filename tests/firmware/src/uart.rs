//! The board's serial port: lines of text, polled.

use core::fmt::{self, Write};

/// UART 0 of the mps2 boards, a CMSDK APB UART.
const BASE: usize = 0x4000_4000;
/// From `BASE`: a byte to send, or the one received.
const DATA: usize = 0;
/// From `BASE`: bit 0, no room to send; bit 1, a byte is there.
const STATE: usize = 4;
/// From `BASE`: bit 0, send; bit 1, receive.
const CONTROL: usize = 8;
/// From `BASE`: clocks of a bit.
const DIVIDER: usize = 16;

const FULL: u32 = 1;
const WAITING: u32 = 2;

/// Characters of a line.
pub const LINE: usize = 256;

/// The serial port.
#[derive(Debug)]
pub struct Uart(());

fn register(offset: usize) -> *mut u32 {
    core::ptr::with_exposed_provenance_mut(BASE + offset)
}

impl Uart {
    /// The port, ready.
    ///
    /// # Safety
    /// The board is an mps2, and there is one of these.
    pub unsafe fn new() -> Self {
        // SAFETY: registers of the board.
        unsafe {
            register(DIVIDER).write_volatile(217);
            register(CONTROL).write_volatile(3);
        }
        Self(())
    }

    fn state(&self) -> u32 {
        // SAFETY: a register of the board, see `new`.
        unsafe { register(STATE).read_volatile() }
    }

    fn byte(&mut self) -> u8 {
        while self.state() & WAITING == 0 {}
        // SAFETY: as above.
        unsafe { register(DATA).read_volatile() as u8 }
    }

    /// The next line, without its end, in the given room; `None` if there was
    /// no room or it is no text.
    pub fn line<'a>(&mut self, room: &'a mut [u8; LINE]) -> Option<&'a str> {
        let mut length = 0;
        loop {
            match (self.byte(), room.get_mut(length)) {
                (b'\n', _) => return core::str::from_utf8(room.get(..length)?).ok(),
                (byte, Some(place)) => *place = byte,
                (_, None) => (),
            }
            length += 1;
        }
    }
}

impl Write for Uart {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            while self.state() & FULL != 0 {}
            // SAFETY: as above.
            unsafe { register(DATA).write_volatile(u32::from(byte)) };
        }
        Ok(())
    }
}
