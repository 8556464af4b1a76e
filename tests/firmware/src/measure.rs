//! Instruction counts under `qemu -icount shift=0`.

use core::hint::black_box;

use cortex_m::peripheral::{SYST, syst::SystClkSource};

/// QEMU lets an instruction take 1 ns and the board's SysTick runs at 25 MHz.
const INSTRUCTIONS_PER_TICK: u64 = 40;

/// SysTick as an instruction counter.
pub struct Counter(SYST);

impl Counter {
    /// Starts SysTick on the processor clock.
    pub fn new(mut systick: SYST) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(0x00ff_ffff);
        systick.clear_current();
        systick.enable_counter();
        Self(systick)
    }

    /// Tenths of instructions that `work` takes for one of `inputs`, less what
    /// the loop over the inputs takes. Let `work` call a function that is never
    /// inlined, or constants move out of the loop. Every input is taken `rounds`
    /// times; 1,000 calls or more, as one tick is 40 instructions, and 600
    /// million instructions at most.
    pub fn tenths_per_call<I>(&mut self, rounds: u32, inputs: &[I], work: impl Fn(&I)) -> u64 {
        let empty = self.ticks(rounds, inputs, |_| ());
        let full = self.ticks(rounds, inputs, work);
        let calls = u64::from(rounds) * inputs.len() as u64;
        (full.saturating_sub(empty) * INSTRUCTIONS_PER_TICK * 10).checked_div(calls).unwrap_or(0)
    }

    /// Instructions of the longest single call of `work` over `inputs`, to
    /// within one SysTick, 40 instructions.
    #[allow(dead_code, reason = "only the first image looks for it")]
    pub fn longest<I>(&mut self, inputs: impl Iterator<Item = I>, work: impl Fn(&I)) -> u64 {
        let ticks = inputs.map(|input| self.ticks(1, &[input], &work)).max();
        ticks.unwrap_or(0) * INSTRUCTIONS_PER_TICK
    }

    fn ticks<I>(&mut self, rounds: u32, inputs: &[I], work: impl Fn(&I)) -> u64 {
        self.0.clear_current();
        let start = SYST::get_current();
        for _ in 0..rounds {
            for input in inputs {
                work(black_box(input));
            }
        }
        u64::from(start.wrapping_sub(SYST::get_current()) & 0x00ff_ffff)
    }
}
