//! Signs of life on standard error, for work that may take longer than a second.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A sign of life whose words change, gone when it is dropped.
pub struct Showing(ProgressBar);

impl Showing {
    /// Says nothing yet.
    pub fn new() -> Self {
        let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}").expect("the template is well formed");
        let bar = ProgressBar::new_spinner().with_style(style);
        bar.enable_steady_tick(Duration::from_millis(100));
        Showing(bar)
    }

    /// Says what is being done.
    pub fn tell(&self, what: String) {
        self.0.set_message(what);
    }
}

impl Default for Showing {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Showing {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Runs `work` while a terminal shows what is being done and for how long. Elsewhere nothing is shown.
pub fn while_showing<T>(what: String, work: impl FnOnce() -> T) -> T {
    let showing = Showing::new();
    showing.tell(what);
    work()
}
