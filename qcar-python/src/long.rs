//! Long work, which runs without the lock of the interpreter and is cancelled if the user presses Ctrl-C.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use qcar::stopping::{self, Stop};

/// Interval between checks for signals.
const BETWEEN: Duration = Duration::from_millis(50);

/// Stack size, the same as that of a main thread: the compiler recurses over the expressions of a model.
const STACK: usize = 8 << 20;

/// Runs `work` on a separate thread while this one checks for signals.
///
/// # Errors
/// Fails with the exception of a signal, such as `KeyboardInterrupt`, after the work has ended.
pub fn long<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let (finished, heard) = channel::<()>();
    let (done, signal) = py.detach(move || {
        let stop = Stop::default();
        thread::scope(|scope| {
            let own = &stop;
            let worker = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, move || {
                let _told_when_dropped = finished;
                stopping::unless(own, work)
            });
            let signal = listen(&heard, own);
            (worker.map(|worker| worker.join()), signal)
        })
    });
    match (done?, signal) {
        (Err(panic), _) => std::panic::resume_unwind(panic),
        (Ok(_), Some(signal)) => Err(signal),
        (Ok(result), None) => Ok(result.expect("nobody else stops it")),
    }
}

/// Waits until the work is finished; the first signal that raises an exception cancels it.
fn listen(finished: &Receiver<()>, stop: &Stop) -> Option<PyErr> {
    let mut raised = None;
    while let Err(RecvTimeoutError::Timeout) = finished.recv_timeout(BETWEEN) {
        if let Err(signal) = Python::attach(|py| py.check_signals()) {
            stop.store(true, Ordering::Relaxed);
            raised.get_or_insert(signal);
        }
    }
    raised
}
