//! Eigenvectors of a matrix whose eigenvalues are known, by inverse iteration.
//!
//! A state of a model acts on few others. If the states are ordered so that those which act on each other are close (E.
//! Cuthill, J. McKee, "Reducing the bandwidth of sparse symmetric matrices", ACM 1969), the matrix is a narrow band,
//! and the work of an elimination grows linearly with the number of states.

use std::collections::VecDeque;

use nalgebra::{Complex, DMatrix, DVector};

/// A matrix in band form, for its eigenvectors.
pub(crate) struct Eigenvectors {
    /// The state at each position of the ordering.
    order: Vec<usize>,
    /// Bandwidth: the largest distance between positions whose states act on each other.
    band: usize,
    /// Row, column (both as positions) and value of each nonzero.
    entries: Vec<(usize, usize, f64)>,
}

impl Eigenvectors {
    /// Orders the states of a square matrix.
    pub fn of(a: &DMatrix<f64>) -> Self {
        let order = order(a);
        let mut places = vec![0; order.len()];
        order
            .iter()
            .enumerate()
            .for_each(|(place, &state)| places[state] = place);
        let entry = |(at, &value): (usize, &f64)| {
            let (row, column) = (at % a.nrows(), at / a.nrows());
            (value != 0.0).then(|| (places[row], places[column], value))
        };
        let entries: Vec<_> = a.iter().enumerate().filter_map(entry).collect();
        let distances = entries.iter().map(|(row, column, _)| row.abs_diff(*column));
        Self {
            order,
            band: distances.max().unwrap_or(0),
            entries,
        }
    }

    /// The eigenvector of the eigenvalue that is nearest to `root`; its norm is 1.
    pub fn nearest(&self, root: Complex<f64>) -> DVector<Complex<f64>> {
        const SHIFT: f64 = 1e-9;
        const STEPS: usize = 3;
        let count = self.order.len();
        let factors = self.factors(root * (1.0 + SHIFT));
        let mut vector = DVector::from_iterator(
            count,
            self.order
                .iter()
                .map(|state| Complex::new(1.0, *state as f64 / count as f64)),
        );
        for _ in 0..STEPS {
            factors.solve(vector.as_mut_slice());
            vector.unscale_mut(vector.norm());
        }
        let mut eigenvector = DVector::zeros(count);
        self.order
            .iter()
            .zip(&vector)
            .for_each(|(&state, value)| eigenvector[state] = *value);
        eigenvector
    }

    /// The factors of the matrix less `shift` on its diagonal.
    fn factors(&self, shift: Complex<f64>) -> Factors {
        let (count, band) = (self.order.len(), self.band);
        let mut rows = Banded::zero(count, band);
        for &(row, column, value) in &self.entries {
            *rows.entry_mut(row, column) = value.into();
        }
        (0..count).for_each(|place| *rows.entry_mut(place, place) -= shift);
        Factors::of(rows, band)
    }
}

/// The states in the order of Cuthill and McKee.
fn order(a: &DMatrix<f64>) -> Vec<usize> {
    let count = a.nrows();
    let acts = |one: usize, other: usize| one != other && (a[(one, other)] != 0.0 || a[(other, one)] != 0.0);
    let neighbours: Vec<Vec<usize>> = (0..count)
        .map(|one| (0..count).filter(|&other| acts(one, other)).collect())
        .collect();
    let mut starts: Vec<usize> = (0..count).collect();
    starts.sort_by_key(|&state| neighbours[state].len());
    let mut is_new = vec![true; count];
    let mut order = Vec::with_capacity(count);
    for start in starts.iter().copied() {
        let mut next = VecDeque::from_iter(std::mem::take(&mut is_new[start]).then_some(start));
        while let Some(state) = next.pop_front() {
            order.push(state);
            let reached = neighbours[state].iter().copied();
            let mut reached: Vec<usize> = reached.filter(|&state| std::mem::take(&mut is_new[state])).collect();
            reached.sort_by_key(|&state| neighbours[state].len());
            next.extend(reached);
        }
    }
    order
}

/// A band matrix, row by row. To the right of the band there is space for entries that row exchanges create.
struct Banded {
    band: usize,
    entries: Vec<Complex<f64>>,
}

impl Banded {
    fn zero(count: usize, band: usize) -> Self {
        Self {
            band,
            entries: vec![Complex::ZERO; count * (3 * band + 1)],
        }
    }

    /// Position of an entry. Neighbouring columns of a row are neighbours.
    fn at(&self, row: usize, column: usize) -> usize {
        row * (3 * self.band + 1) + self.band + column - row
    }

    fn entry(&self, row: usize, column: usize) -> Complex<f64> {
        self.entries[self.at(row, column)]
    }

    fn entry_mut(&mut self, row: usize, column: usize) -> &mut Complex<f64> {
        let at = self.at(row, column);
        &mut self.entries[at]
    }
}

/// The LU factors of a band matrix, with partial pivoting.
struct Factors {
    count: usize,
    /// The upper factor on and above the diagonal, the multipliers of the rows below it.
    rows: Banded,
    /// For each row, the row with which it was exchanged.
    exchanged: Vec<usize>,
}

impl Factors {
    fn of(mut rows: Banded, band: usize) -> Self {
        let count = rows.entries.len() / (3 * band + 1);
        // Replaces a pivot that is zero.
        let least = f64::EPSILON * rows.entries.iter().map(|entry| entry.norm()).fold(0.0, f64::max);
        let mut exchanged = Vec::with_capacity(count);
        for step in 0..count {
            let (below, right) = ((step + band + 1).min(count), (step + 2 * band + 1).min(count));
            let size = |row: &usize| rows.entry(*row, step).norm_sqr();
            let pivot = (step..below).max_by(|one, other| size(one).total_cmp(&size(other)));
            let pivot = pivot.unwrap_or(step);
            exchanged.push(pivot);
            for column in step..right {
                let (one, other) = (rows.at(step, column), rows.at(pivot, column));
                rows.entries.swap(one, other);
            }
            if rows.entry(step, step) == Complex::ZERO {
                *rows.entry_mut(step, step) = least.into();
            }
            for row in step + 1..below {
                let times = rows.entry(row, step) / rows.entry(step, step);
                *rows.entry_mut(row, step) = times;
                for column in step + 1..right {
                    let pivot = rows.entry(step, column);
                    *rows.entry_mut(row, column) -= times * pivot;
                }
            }
        }
        Self { count, rows, exchanged }
    }

    /// Replaces a right-hand side by its solution.
    fn solve(&self, vector: &mut [Complex<f64>]) {
        let (count, band) = (self.count, self.rows.band);
        for (step, &pivot) in self.exchanged.iter().enumerate() {
            vector.swap(step, pivot);
            for row in step + 1..(step + band + 1).min(count) {
                let above = vector[step];
                vector[row] -= self.rows.entry(row, step) * above;
            }
        }
        for row in (0..count).rev() {
            let right = row + 1..(row + 2 * band + 1).min(count);
            let known: Complex<f64> = right.map(|column| self.rows.entry(row, column) * vector[column]).sum();
            vector[row] = (vector[row] - known) / self.rows.entry(row, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::Eigenvectors;

    /// A matrix without structure, and one with two parts that do not act on each other.
    #[test]
    fn a_matrix_scales_its_eigenvectors() {
        let entry = |row: usize, column: usize| ((7 * row + 3 * column * column + 1) as f64).sin();
        let full = DMatrix::from_fn(24, 24, entry);
        let parts = DMatrix::from_fn(
            24,
            24,
            |row, column| {
                if row % 2 == column % 2 { entry(row, column) } else { 0.0 }
            },
        );
        for matrix in [full, parts] {
            let eigenvectors = Eigenvectors::of(&matrix);
            for root in matrix.complex_eigenvalues().iter() {
                let vector = eigenvectors.nearest(*root);
                let left = matrix.map(nalgebra::Complex::from) * &vector - &vector * *root;
                assert!((vector.norm() - 1.0).abs() < 1e-12);
                assert!(left.norm() < 1e-7 * matrix.norm(), "{root} {}", left.norm());
            }
        }
    }
}
