//! The data of a run whose file is not a plain table.

use super::finding::Finding;
use crate::error::Problem;

/// Data of a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunData {
    /// The run's name.
    pub run: String,
    /// Time of the first sample, s.
    pub start: f64,
    /// Sample rate, Hz.
    pub rate: f64,
    /// Name and samples (SI) of each sensor or column, all of one length.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Mappings without a channel in the file.
    pub missing: Vec<MissingChannel>,
    /// Flaws of the samples before resampling.
    pub findings: Vec<Finding>,
}

impl RunData {
    /// True if it has a sensor or column.
    pub fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(own, _)| own == name)
    }

    /// A column of a curve; every curve has all of its columns.
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

/// A mapping without a channel in a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MissingChannel {
    pub name: String,
    pub problem: Problem,
}
