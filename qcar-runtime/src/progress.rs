//! Progress of long work.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

/// Is told how many parts of the work are done, and of how many; from any thread.
pub type Told<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// For those who do not care.
pub const UNTOLD: Told<'static> = &|_, _| ();

/// Does `work` on all items in parallel, and tells at the start and after each; the results are in the order of the items.
pub fn map<T: Sync, U: Send>(items: &[T], told: Told<'_>, work: impl Fn(&T) -> U + Sync + Send) -> Vec<U> {
    map_with(items, told, || (), |(), item| work(item))
}

/// The same with `room`, which a thread keeps from one item to the next and which changes no result.
pub fn map_with<T: Sync, R, U: Send>(
    items: &[T],
    told: Told<'_>,
    room: impl Fn() -> R + Sync + Send,
    work: impl Fn(&mut R, &T) -> U + Sync + Send,
) -> Vec<U> {
    let done = AtomicUsize::new(0);
    told(0, items.len());
    let one = |room: &mut R, item| {
        let result = work(room, item);
        told(done.fetch_add(1, Ordering::Relaxed) + 1, items.len());
        result
    };
    // Nobody waits for the others once one has panicked, which is how work is given up.
    items.par_iter().map_init(room, one).panic_fuse().collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    #[test]
    fn every_part_is_told_once_and_results_keep_their_order() {
        let heard = Mutex::new(Vec::new());
        let squares = super::map(&[3, 1, 2], &|done, of| heard.lock().unwrap().push((done, of)), |n| {
            n * n
        });
        assert_eq!(squares, [9, 1, 4]);
        let mut heard = heard.into_inner().unwrap();
        heard.sort_unstable();
        assert_eq!(heard, [(0, 3), (1, 3), (2, 3), (3, 3)]);
    }
}
