//! Time for embassy from the SysTick of any Cortex-M: an interrupt a
//! millisecond, which counts and wakes whoever is due.

use core::cell::{Cell, RefCell};
use core::task::Waker;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use critical_section::{CriticalSection, Mutex};
use embassy_time_driver::{Driver, TICK_HZ};
use embassy_time_queue_utils::Queue;

/// Of the board's core, Hz.
const CORE_CLOCK: u64 = 25_000_000;

struct SysTick {
    now: Mutex<Cell<u64>>,
    waiting: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static DRIVER: SysTick = SysTick {
    now: Mutex::new(Cell::new(0)),
    waiting: Mutex::new(RefCell::new(Queue::new())),
});

impl SysTick {
    fn wake_due(&self, section: CriticalSection<'_>) {
        if let Ok(mut waiting) = self.waiting.borrow(section).try_borrow_mut() {
            // Wakes and forgets them; when the next is due matters only to
            // drivers that set an alarm.
            waiting.next_expiration(self.now.borrow(section).get());
        }
    }
}

impl Driver for SysTick {
    fn now(&self) -> u64 {
        critical_section::with(|section| self.now.borrow(section).get())
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|section| {
            if let Ok(mut waiting) = self.waiting.borrow(section).try_borrow_mut() {
                waiting.schedule_wake(at, waker);
            }
            // It may be past already.
            self.wake_due(section);
        });
    }
}

/// Starts time.
pub fn start(mut timer: SYST) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload((CORE_CLOCK / TICK_HZ) as u32 - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
}

#[exception]
fn SysTick() {
    critical_section::with(|section| {
        let now = DRIVER.now.borrow(section);
        now.set(now.get() + 1);
        DRIVER.wake_due(section);
    });
}
