//! Signs of life on standard error, for work that may take longer than a second.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Runs `work` while a terminal shows what is being done and for how long. Elsewhere nothing is shown.
pub fn while_showing<T>(what: String, work: impl FnOnce() -> T) -> T {
    let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}").expect("the template is well formed");
    let bar = ProgressBar::new_spinner().with_style(style).with_message(what);
    bar.enable_steady_tick(Duration::from_millis(100));
    let result = work();
    bar.finish_and_clear();
    result
}
