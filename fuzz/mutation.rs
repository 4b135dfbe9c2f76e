//! Randomly damaged files, for bounded runs of the bodies of the fuzz targets.

/// Reproducible pseudo-random numbers (xorshift64*).
pub struct Random(pub u64);

impl Random {
    /// A number in `0..end`.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % end
    }
}

/// Changes a few bytes to values that often break readers, or removes, repeats or cuts off a piece.
pub fn mutated(file: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = file.to_vec();
    // Most headers and directories are at the beginning or at the end.
    let place = |random: &mut Random, length: usize| match random.below(4) {
        0 => random.below(length),
        1 => length - 1 - random.below(length.min(600)),
        _ => random.below(length.min(3000)),
    };
    match random.below(10) {
        0 => bytes.truncate(random.below(file.len())),
        1 => {
            let (at, length) = (place(random, bytes.len()), random.below(300));
            bytes.drain(at..(at + length).min(file.len()));
        }
        2 => {
            let (at, length) = (place(random, bytes.len()), random.below(300));
            let piece = bytes[at..(at + length).min(file.len())].to_vec();
            bytes.splice(at..at, piece);
        }
        _ => {
            for _ in 0..=random.below(4) {
                let at = place(random, bytes.len());
                let values = [
                    0,
                    1,
                    0x7f,
                    0x80,
                    0xff,
                    random.below(256) as u8,
                    bytes[at].wrapping_add(1),
                ];
                let value = values[random.below(values.len())];
                let end = (at + [1, 1, 2, 4, 8][random.below(5)]).min(bytes.len());
                bytes[at..end].fill(value);
            }
        }
    }
    bytes
}
