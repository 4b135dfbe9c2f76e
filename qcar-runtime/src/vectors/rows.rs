//! Rows of lanes in memory.

use std::ops::{Deref, DerefMut};

use crate::model::{LANES, Lanes};

/// Bytes of a cache line, which holds a row.
const LINE: usize = 64;

/// Rows that begin at cache lines. A load of AVX-512 across two lines takes twice as long, and the global allocator
/// places memory at multiples of 16 bytes only.
pub(crate) struct Rows {
    numbers: Vec<f64>,
    /// Index of the first number of the first row.
    first: usize,
}

impl Rows {
    /// So many rows of zeros.
    pub fn zero(count: usize) -> Self {
        let numbers = vec![0.0; (count + 1) * LANES - 1];
        let first = numbers.as_ptr().align_offset(LINE).min(LANES - 1);
        Self { numbers, first }
    }
}

impl Deref for Rows {
    type Target = [Lanes];

    #[inline(always)]
    fn deref(&self) -> &[Lanes] {
        self.numbers[self.first..].as_chunks().0
    }
}

impl DerefMut for Rows {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [Lanes] {
        self.numbers[self.first..].as_chunks_mut().0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_begin_at_cache_lines() {
        for count in [0, 1, 20, 333] {
            let mut rows = Rows::zero(count);
            rows.iter_mut().for_each(|row| row.fill(1.0));
            assert_eq!(*rows, vec![[1.0; LANES]; count]);
            assert!(rows.as_ptr().addr().is_multiple_of(LINE), "{count} rows");
        }
    }
}
