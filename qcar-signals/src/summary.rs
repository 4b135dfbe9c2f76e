//! Statistics of a channel from one pass over its samples, which need not be kept.

/// Number of equal parts of a channel, each with its own mean.
const PARTS: usize = 16;

/// Range, mean, RMS and shape of a channel, in its unit. Samples without a valid value are only counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Number of samples.
    pub samples: usize,
    /// Number of samples with a valid value.
    pub valid: usize,
    /// The lowest valid value; infinity if there is none.
    pub min: f64,
    /// The highest valid value; minus infinity if there is none.
    pub max: f64,
    sum: f64,
    squares: f64,
    /// Sum and number of the valid values of each part so far.
    parts: Vec<(f64, usize)>,
    /// Samples of a part.
    part: usize,
}

impl Summary {
    /// Empty summary of a channel that will have this number of samples.
    pub(crate) fn new(samples: usize) -> Self {
        Summary {
            samples: 0,
            valid: 0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            sum: 0.0,
            squares: 0.0,
            parts: Vec::with_capacity(PARTS),
            part: samples.div_ceil(PARTS).max(1),
        }
    }

    /// Adds the next samples. Sums are taken in the order of the samples, so they do not depend on how these are
    /// divided into calls.
    pub(crate) fn add(&mut self, mut samples: impl ExactSizeIterator<Item = f64>) {
        while samples.len() > 0 {
            let within = self.samples % self.part;
            if within == 0 {
                self.parts.push((0.0, 0));
            }
            let count = samples.len().min(self.part - within);
            let (mut sum, mut valid) = self.parts.pop().unwrap_or_default();
            for value in samples.by_ref().take(count).filter(|value| value.is_finite()) {
                valid += 1;
                sum += value;
                self.min = self.min.min(value);
                self.max = self.max.max(value);
                self.sum += value;
                self.squares += value * value;
                self.valid += 1;
            }
            self.parts.push((sum, valid));
            self.samples += count;
        }
    }

    /// Mean of the valid values; `None` without any.
    pub fn mean(&self) -> Option<f64> {
        self.of_valid(self.sum)
    }

    /// Root mean square of the valid values; `None` without any.
    pub fn rms(&self) -> Option<f64> {
        self.of_valid(self.squares).map(f64::sqrt)
    }

    /// The means of up to sixteen equal parts, the last of which may be shorter; NaN for a part without a valid value.
    pub fn part_means(&self) -> impl Iterator<Item = f64> + '_ {
        self.parts.iter().map(|&(sum, valid)| sum / valid as f64)
    }

    fn of_valid(&self, sum: f64) -> Option<f64> {
        (self.valid > 0).then(|| sum / self.valid as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::Summary;

    /// The numbers of a hundred samples by hand, and the same in calls of any length.
    #[test]
    fn a_summary_does_not_depend_on_its_pieces() {
        let samples: Vec<f64> = (0..100)
            .map(|at| if at % 10 == 3 { f64::NAN } else { f64::from(at) })
            .collect();
        let in_pieces = |length: usize| {
            let mut summary = Summary::new(samples.len());
            samples
                .chunks(length)
                .for_each(|piece| summary.add(piece.iter().copied()));
            summary
        };
        let whole = in_pieces(100);
        assert_eq!((whole.samples, whole.valid, whole.min, whole.max), (100, 90, 0.0, 99.0));
        // 4950 less 3, 13 to 93.
        assert_eq!(whole.mean(), Some((4950.0 - 480.0) / 90.0));
        let squares: u32 = (0..100).filter(|at| at % 10 != 3).map(|at| at * at).sum();
        assert_eq!(whole.rms(), Some((f64::from(squares) / 90.0).sqrt()));
        // Fifteen parts of seven samples; the last has 98 and 99, the first lacks 3.
        let means: Vec<f64> = whole.part_means().collect();
        assert_eq!((means.len(), means[0], means[14]), (15, 3.0, 98.5));
        for length in [1, 2, 7, 8, 33] {
            assert_eq!(in_pieces(length), whole, "pieces of {length}");
        }
        assert_eq!(Summary::new(0).mean(), None);
    }
}
