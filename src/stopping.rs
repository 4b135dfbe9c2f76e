//! Cancellation of work. A program that contains qcar, such as Python, does not end when its user presses Ctrl-C, so
//! the work ends at its next progress report.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Flag that cancels work.
pub type Stop = Arc<AtomicBool>;

/// Panic payload that unwinds cancelled work.
struct Stopped;

thread_local! {
    /// Flag of the work of this thread.
    static STOP: RefCell<Option<Stop>> = const { RefCell::new(None) };
}

/// Runs `work`; `None` if `stop` was set meanwhile.
pub fn unless<T>(stop: &Stop, work: impl FnOnce() -> T) -> Option<T> {
    let outer = STOP.replace(Some(Arc::clone(stop)));
    let done = catch_unwind(AssertUnwindSafe(work));
    STOP.set(outer);
    match done {
        Ok(result) => Some(result),
        Err(reason) if reason.is::<Stopped>() => None,
        Err(reason) => resume_unwind(reason),
    }
}

/// The flag of the work of this thread, for threads that help it; `None` if it cannot be cancelled.
pub fn of_this_work() -> Option<Stop> {
    STOP.with_borrow(Clone::clone)
}

/// Ends the work here if it is cancelled.
pub fn here(stop: Option<&Stop>) {
    if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
        resume_unwind(Box::new(Stopped));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::Ordering;

    use super::{Stop, here, of_this_work, unless};

    #[test]
    fn work_ends_at_its_next_sign_of_life() {
        let stop = Stop::default();
        let mut done = 0;
        let ended = unless(&stop, || {
            let stop = of_this_work();
            for part in 0..5 {
                here(stop.as_ref());
                done += 1;
                stop.as_ref().unwrap().store(part == 2, Ordering::Relaxed);
            }
        });
        assert_eq!((ended, done), (None, 3));
        assert!(of_this_work().is_none());
    }

    #[test]
    fn work_that_nobody_stops_gives_its_result() {
        assert_eq!(unless(&Arc::default(), || 7), Some(7));
        here(None);
    }

    #[test]
    #[should_panic(expected = "a mistake in the work")]
    fn what_is_wrong_with_the_work_is_not_hidden() {
        unless(&Arc::default(), || panic!("a mistake in the work"));
    }
}
