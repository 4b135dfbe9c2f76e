//! Progress on standard error of work that may take longer than a second: the task, and how far it is.
//! They are seen on a terminal alone, never in a pipe or a file.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use qcar_runtime::progress::Told;

use crate::stopping::{self, Stop};

/// What is shown now, so that an interruption can say what it ended.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// A sign of life whose words change, gone when it is dropped. Work that is to stop ends where it gives one.
pub struct Showing {
    bar: ProgressBar,
    stop: Option<Stop>,
}

impl Showing {
    /// Says nothing yet.
    pub fn new() -> Self {
        let bar = ProgressBar::new_spinner().with_style(style("{spinner} {wide_msg} {elapsed}"));
        bar.enable_steady_tick(Duration::from_millis(100));
        show(Some(bar.clone()));
        Showing {
            bar,
            stop: stopping::of_this_work(),
        }
    }

    /// Says what is being done.
    pub fn tell(&self, what: String) {
        stopping::here(self.stop.as_ref());
        self.bar.set_message(what);
    }

    /// Says how much of it is done, and of how much.
    pub fn far(&self, done: usize, of: usize) {
        stopping::here(self.stop.as_ref());
        self.bar.set_position(done as u64);
        if self.bar.length() != Some(of as u64) {
            self.bar
                .set_style(style("{spinner} {wide_msg} {pos} of {len} {bar:12} {elapsed}"));
            self.bar.set_length(of as u64);
        }
    }
}

impl Default for Showing {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Showing {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        show(None);
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is well formed")
}

fn show(bar: Option<ProgressBar>) -> Option<ProgressBar> {
    let mut shown = SHOWN.lock().unwrap_or_else(PoisonError::into_inner);
    std::mem::replace(&mut shown, bar)
}

/// Takes away what is shown, and gives its words.
pub fn clear() -> Option<String> {
    let bar = show(None)?;
    let far = bar
        .length()
        .map_or(String::new(), |of| format!(" {} of {of}", bar.position()));
    bar.finish_and_clear();
    Some(bar.message() + &far)
}

/// Runs `work`, which tells how far it is, while a terminal shows it.
pub fn while_counting<T>(what: String, work: impl FnOnce(Told<'_>) -> T) -> T {
    let showing = Showing::new();
    showing.tell(what);
    work(&|done, of| showing.far(done, of))
}
