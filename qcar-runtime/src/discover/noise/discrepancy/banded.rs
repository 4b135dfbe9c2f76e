//! Symmetric matrix with a band of variable width, and its Cholesky factor.

use std::ops::Range;

use crate::vectors::dot;

/// The lower triangle, row by row.
#[derive(Clone, Debug)]
pub struct Banded {
    /// Column of the first entry of each row.
    first: Vec<usize>,
    /// Position of the first entry of each row, and the number of entries at the end.
    start: Vec<usize>,
    entries: Vec<f64>,
}

impl Banded {
    /// A matrix with this number of rows. `columns` gives the columns of a row up to and including its diagonal.
    pub fn new(rows: usize, columns: impl Fn(usize) -> Range<usize>, entry: impl Fn(usize, usize) -> f64) -> Self {
        let mut banded = Self {
            first: Vec::with_capacity(rows),
            start: vec![0],
            entries: Vec::new(),
        };
        for row in 0..rows {
            let columns = columns(row);
            banded.first.push(columns.start);
            banded.entries.extend(columns.map(|column| entry(row, column)));
            banded.start.push(banded.entries.len());
        }
        banded
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.entries.len()
    }

    /// `1 + factor · self`.
    pub fn identity_plus(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        scaled.entries.iter_mut().for_each(|entry| *entry *= factor);
        for row in 0..self.first.len() {
            scaled.entries[self.start[row + 1] - 1] += 1.0;
        }
        scaled
    }

    /// Lower triangular factor of a positive definite matrix.
    pub fn cholesky(mut self) -> Self {
        for row in 0..self.first.len() {
            let (before, rest) = self.entries.split_at_mut(self.start[row]);
            let own = &mut rest[..self.start[row + 1] - self.start[row]];
            let first = self.first[row];
            for column in first..row {
                let other = &before[self.start[column]..self.start[column + 1]];
                let other_first = self.first[column];
                let shared = first.max(other_first);
                let left = &own[shared - first..column - first];
                let right = &other[shared - other_first..column - other_first];
                own[column - first] = (own[column - first] - dot(left, right)) / other[other.len() - 1];
            }
            let (diagonal, left) = own.split_last_mut().expect("a row ends with its diagonal");
            *diagonal = (*diagonal - dot(left, left)).max(f64::MIN_POSITIVE).sqrt();
        }
        self
    }

    /// Solves `L x = b` in place.
    pub fn forward(&self, b: &mut [f64]) {
        for row in 0..self.first.len() {
            let own = &self.entries[self.start[row]..self.start[row + 1]];
            let (diagonal, left) = own.split_last().expect("a row ends with its diagonal");
            b[row] = (b[row] - dot(left, &b[self.first[row]..row])) / diagonal;
        }
    }

    /// Logarithms of the diagonal entries.
    pub fn log_diagonal(&self) -> impl Iterator<Item = f64> {
        self.start[1..].iter().map(|end| self.entries[end - 1].ln())
    }
}

#[cfg(test)]
impl Banded {
    /// `L x`.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let row = |row: usize| {
            let own = &self.entries[self.start[row]..self.start[row + 1]];
            dot(own, &x[self.first[row]..=row])
        };
        (0..self.first.len()).map(row).collect()
    }
}
