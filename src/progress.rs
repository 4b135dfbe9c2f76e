//! Progress of work that may take longer than a second: the task and its completed part, on standard error. It is shown
//! on a terminal only, never in a pipe or a file.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use qcar_runtime::progress::OnProgress;

use crate::stopping::{self, Stop};

/// What is shown now, for the message of an interruption.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// A progress line, which is removed when it is dropped. Cancelled work ends at its next report.
pub struct Showing {
    bar: ProgressBar,
    stop: Option<Stop>,
}

impl Showing {
    /// An empty line.
    pub fn new() -> Self {
        let bar = ProgressBar::new_spinner().with_style(style("{spinner} {wide_msg} {elapsed}"));
        bar.enable_steady_tick(Duration::from_millis(100));
        show(Some(bar.clone()));
        Showing {
            bar,
            stop: stopping::of_this_work(),
        }
    }

    /// Shows the current step.
    pub fn step(&self, what: String) {
        stopping::here(self.stop.as_ref());
        self.bar.set_message(what);
    }

    /// Shows the number of completed parts and of all parts.
    pub fn count(&self, done: usize, of: usize) {
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

/// Removes the progress line from the terminal and returns its text.
pub fn clear() -> Option<String> {
    let bar = show(None)?;
    let far = bar
        .length()
        .map_or(String::new(), |of| format!(" {} of {of}", bar.position()));
    bar.finish_and_clear();
    Some(bar.message() + &far)
}

/// Runs `work` and shows its progress in a terminal.
pub fn while_counting<T>(what: String, work: impl FnOnce(OnProgress<'_>) -> T) -> T {
    let showing = Showing::new();
    showing.step(what);
    work(&|done, of| showing.count(done, of))
}
