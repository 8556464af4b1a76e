use std::borrow::Cow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// A bar on standard error that appears after a second, and only on a terminal.
pub struct Bar {
    start: Instant,
    what: &'static str,
    bar: Mutex<Option<ProgressBar>>,
}

impl Bar {
    pub fn new(what: &'static str) -> Self {
        Self { start: Instant::now(), what, bar: Mutex::new(None) }
    }

    pub fn update(&self, done: usize, total: usize) {
        if self.start.elapsed() < Duration::from_secs(1) {
            return;
        }
        let mut bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        let bar = bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("{msg} {bar:30} {pos}/{len} {eta}")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(total as u64).with_style(style).with_message(self.what)
        });
        bar.set_position(done as u64);
    }

    /// Another step of work of unknown length.
    pub fn stage(&self, what: impl Into<Cow<'static, str>>) {
        if self.start.elapsed() < Duration::from_secs(1) {
            return;
        }
        let mut bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        let bar = bar.get_or_insert_with(ProgressBar::new_spinner);
        bar.set_message(what);
        bar.tick();
    }

    pub fn finish(&self) {
        if let Some(bar) = self.bar.lock().unwrap_or_else(PoisonError::into_inner).take() {
            bar.finish_and_clear();
        }
    }
}
