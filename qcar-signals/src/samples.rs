//! The samples of a channel, as narrow as the file stores them.

use std::ops::Range;

/// Physical values; not a number where the file has no valid one.
#[derive(Clone, Debug)]
pub struct Samples(Stored);

#[derive(Clone, Debug)]
enum Stored {
    Doubles(Vec<f64>),
    Singles(Vec<f32>),
    /// To be taken times a factor.
    Shorts(Vec<i16>, f64),
}

impl Samples {
    /// Of single precision.
    pub(crate) fn singles(samples: Vec<f32>) -> Self {
        Samples(Stored::Singles(samples))
    }

    /// Short integers, each of which is to be taken times a factor.
    pub(crate) fn shorts(stored: Vec<i16>, factor: f64) -> Self {
        Samples(Stored::Shorts(stored, factor))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match &self.0 {
            Stored::Doubles(own) => own.len(),
            Stored::Singles(own) => own.len(),
            Stored::Shorts(own, _) => own.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One of them.
    ///
    /// # Panics
    /// There is none at this index.
    pub fn at(&self, index: usize) -> f64 {
        match &self.0 {
            Stored::Doubles(own) => own[index],
            Stored::Singles(own) => own[index].into(),
            Stored::Shorts(own, factor) => f64::from(own[index]) * factor,
        }
    }

    /// All of them.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator + Clone + '_ {
        self.range(0..self.len())
    }

    /// Those of these indices.
    ///
    /// # Panics
    /// As it goes on, where there is none at an index.
    pub fn range(&self, of: Range<usize>) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator + Clone + '_ {
        of.map(|index| self.at(index))
    }

    /// All of them in double precision.
    pub fn to_vec(&self) -> Vec<f64> {
        self.iter().collect()
    }
}

/// None.
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

/// Of the values, however they are stored.
impl PartialEq for Samples {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}
