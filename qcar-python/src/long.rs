//! Work that takes long: without the lock of the interpreter, and given up when the user presses Ctrl-C.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use qcar::stopping::{self, Stop};

/// How often Python is asked for signals.
const BETWEEN: Duration = Duration::from_millis(50);

/// As much as a main thread has: the compiler goes as deep as a model's expressions.
const STACK: usize = 8 << 20;

/// Does `work` on a thread of its own, while this one listens for signals.
///
/// # Errors
/// What a signal raises, such as `KeyboardInterrupt`: the work has ended by then.
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

/// Waits until the work is finished; the first signal that raises something stops it.
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
