//! Hash tables for the small keys of this compiler: a fifth of its work went into SipHash, which defends against keys
//! that an enemy chooses. Nothing depends on the order of a table.

use std::hash::{BuildHasherDefault, Hasher};

/// A table by [`Multiplicative`] hashes.
pub type HashMap<K, V> = std::collections::HashMap<K, V, BuildHasherDefault<Multiplicative>>;

/// A set by [`Multiplicative`] hashes.
pub type HashSet<K> = std::collections::HashSet<K, BuildHasherDefault<Multiplicative>>;

/// Multiplies by an odd constant near 2⁶⁴/φ after each word (Knuth, The Art of Computer Programming 3, section 6.4).
#[derive(Clone, Copy, Debug, Default)]
pub struct Multiplicative(u64);

impl Multiplicative {
    fn mix(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

impl Hasher for Multiplicative {
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.mix(u64::from_le_bytes(word));
        }
    }

    fn write_u8(&mut self, word: u8) {
        self.mix(word.into());
    }

    fn write_u16(&mut self, word: u16) {
        self.mix(word.into());
    }

    fn write_u32(&mut self, word: u32) {
        self.mix(word.into());
    }

    fn write_u64(&mut self, word: u64) {
        self.mix(word);
    }

    fn write_isize(&mut self, word: isize) {
        self.mix(word as u64);
    }

    /// The best bits of a product are its highest; a table looks at the lowest.
    fn finish(&self) -> u64 {
        self.0.rotate_left(26)
    }
}
