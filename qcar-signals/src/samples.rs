//! The samples of a channel in the type in which the file stores them.

use std::ops::Range;

use crate::summary::Summary;

/// Physical values; NaN if the file has no valid one.
#[derive(Clone, Debug)]
pub struct Samples(Stored);

#[derive(Clone, Debug)]
enum Stored {
    Doubles(Vec<f64>),
    Singles(Vec<f32>),
    /// Values to be multiplied by a factor.
    Shorts(Vec<i16>, f64),
    /// A summary from one pass over the samples, of which none is stored.
    Summarised(Box<Summary>),
}

impl Samples {
    /// Samples of single precision.
    pub(crate) fn singles(samples: Vec<f32>) -> Self {
        Samples(Stored::Singles(samples))
    }

    /// Short integers, each to be multiplied by a factor.
    pub(crate) fn shorts(stored: Vec<i16>, factor: f64) -> Self {
        Samples(Stored::Shorts(stored, factor))
    }

    /// A summary without samples.
    pub(crate) fn summarised(summary: Summary) -> Self {
        Samples(Stored::Summarised(Box::new(summary)))
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        match &self.0 {
            Stored::Doubles(own) => own.len(),
            Stored::Singles(own) => own.len(),
            Stored::Shorts(own, _) => own.len(),
            Stored::Summarised(_) => 0,
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
            Stored::Summarised(_) => panic!("no samples are kept of a channel that was summarised"),
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

    /// The summary that is stored instead of samples; `None` if the samples are stored.
    pub fn stored_summary(&self) -> Option<&Summary> {
        match &self.0 {
            Stored::Summarised(summary) => Some(summary),
            Stored::Doubles(_) | Stored::Singles(_) | Stored::Shorts(..) => None,
        }
    }

    /// The summary of the samples.
    pub fn summary(&self) -> Summary {
        match &self.0 {
            Stored::Summarised(summary) => (**summary).clone(),
            Stored::Doubles(own) => summary(own.iter().copied()),
            Stored::Singles(own) => summary(own.iter().map(|&sample| sample.into())),
            Stored::Shorts(own, factor) => summary(own.iter().map(|&sample| f64::from(sample) * factor)),
        }
    }

    /// All of them in double precision.
    pub fn to_vec(&self) -> Vec<f64> {
        self.iter().collect()
    }
}

fn summary(samples: impl ExactSizeIterator<Item = f64>) -> Summary {
    let mut summary = Summary::new(samples.len());
    summary.add(samples);
    summary
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
