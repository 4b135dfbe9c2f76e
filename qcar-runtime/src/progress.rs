//! Progress of long work.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

/// Receives the number of completed parts of some work and the number of all parts, from any thread.
pub type OnProgress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Ignores the progress.
pub const NO_PROGRESS: OnProgress<'static> = &|_, _| ();

/// Does `work` on all items in parallel and reports the progress at the start and after each item. The results are in
/// the order of the items.
pub fn map<T: Sync, U: Send>(items: &[T], on_progress: OnProgress<'_>, work: impl Fn(&T) -> U + Sync + Send) -> Vec<U> {
    map_with(items, on_progress, || (), |(), item| work(item))
}

/// The same with a value from `buffer` that a thread keeps from one item to the next. The value must not affect any
/// result.
pub fn map_with<T: Sync, R, U: Send>(
    items: &[T],
    on_progress: OnProgress<'_>,
    buffer: impl Fn() -> R + Sync + Send,
    work: impl Fn(&mut R, &T) -> U + Sync + Send,
) -> Vec<U> {
    let done = AtomicUsize::new(0);
    on_progress(0, items.len());
    let one = |buffer: &mut R, item| {
        let result = work(buffer, item);
        on_progress(done.fetch_add(1, Ordering::Relaxed) + 1, items.len());
        result
    };
    // A panic cancels the work, so the other items need not be completed.
    items.par_iter().map_init(buffer, one).panic_fuse().collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    #[test]
    fn every_part_is_reported_once_and_results_keep_their_order() {
        let received = Mutex::new(Vec::new());
        let squares = super::map(&[3, 1, 2], &|done, of| received.lock().unwrap().push((done, of)), |n| {
            n * n
        });
        assert_eq!(squares, [9, 1, 4]);
        let mut received = received.into_inner().unwrap();
        received.sort_unstable();
        assert_eq!(received, [(0, 3), (1, 3), (2, 3), (3, 3)]);
    }
}
