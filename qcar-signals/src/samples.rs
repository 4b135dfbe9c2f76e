//! The samples of a channel in the type in which the file stores them.

use std::ops::Range;

/// Physical values; NaN for an invalid value.
#[derive(Clone, Debug)]
pub struct Samples(Stored);

#[derive(Clone, Debug)]
enum Stored {
    Doubles(Vec<f64>),
    Singles(Vec<f32>),
    /// Values to be multiplied by a factor.
    Shorts(Vec<i16>, f64),
}

impl Samples {
    /// Of single precision.
    pub(crate) fn singles(samples: Vec<f32>) -> Self {
        Samples(Stored::Singles(samples))
    }

    /// Short integers, each to be multiplied by a factor.
    pub(crate) fn shorts(stored: Vec<i16>, factor: f64) -> Self {
        Samples(Stored::Shorts(stored, factor))
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        match &self.0 {
            Stored::Doubles(own) => own.len(),
            Stored::Singles(own) => own.len(),
            Stored::Shorts(own, _) => own.len(),
        }
    }

    /// True without samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A sample.
    ///
    /// # Panics
    /// If there is none at this position.
    pub fn at(&self, index: usize) -> f64 {
        match &self.0 {
            Stored::Doubles(own) => own[index],
            Stored::Singles(own) => own[index].into(),
            Stored::Shorts(own, factor) => f64::from(own[index]) * factor,
        }
    }

    /// All samples.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator + Clone + '_ {
        self.range(0..self.len())
    }

    /// The samples at these positions.
    ///
    /// # Panics
    /// During iteration, if there is none at a position.
    pub fn range(&self, of: Range<usize>) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator + Clone + '_ {
        of.map(|index| self.at(index))
    }

    /// All samples in double precision.
    pub fn to_vec(&self) -> Vec<f64> {
        self.iter().collect()
    }
}

/// No samples.
impl Default for Samples {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl From<Vec<f64>> for Samples {
    fn from(samples: Vec<f64>) -> Self {
        Samples(Stored::Doubles(samples))
    }
}

impl<T: AsRef<[f64]>> PartialEq<T> for Samples {
    fn eq(&self, other: &T) -> bool {
        self.iter().eq(other.as_ref().iter().copied())
    }
}

/// Equality of values, for any storage type.
impl PartialEq for Samples {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}
