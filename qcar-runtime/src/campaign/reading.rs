//! The data of a run whose file is not a plain table.

use super::finding::Finding;
use crate::error::Problem;

/// What was read of a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Recorded {
    /// The run's name.
    pub run: String,
    /// Time of the first sample, s.
    pub start: f64,
    /// Hz.
    pub rate: f64,
    /// Name and samples (SI) of each sensor or column, all of one length.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Taps that the file has no channel for.
    pub missing: Vec<Missing>,
    /// What the samples show to be odd, before they were resampled.
    pub findings: Vec<Finding>,
}

impl Recorded {
    /// Whether it has a sensor or column.
    pub fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(own, _)| own == name)
    }

    /// A column of a curve, which none lacks.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let column = self.columns.iter().find(|(own, _)| own == name);
        column.expect("a curve without this column was refused").1.clone()
    }

    /// The times of the samples, s.
    pub fn times(&self) -> Vec<f64> {
        let count = self.columns.first().map_or(0, |(_, samples)| samples.len());
        (0..count).map(|at| self.start + at as f64 / self.rate).collect()
    }
}

/// A tap that a file has no channel for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Missing {
    pub name: String,
    pub problem: Problem,
}
