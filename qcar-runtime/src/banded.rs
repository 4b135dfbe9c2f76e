//! Sparse matrices as narrow bands.
//!
//! A state of a model acts on few others. If the states are ordered so that those which act on each other are close (E.
//! Cuthill, J. McKee, "Reducing the bandwidth of sparse symmetric matrices", ACM 1969), the matrix is a narrow band,
//! and the work of an elimination grows linearly with the number of states.

use std::collections::VecDeque;

use nalgebra::{Complex, DMatrix, DVector};

/// A square matrix with its states in an order in which it is a narrow band.
pub(crate) struct Ordered {
    /// The state at each position of the ordering.
    order: Vec<usize>,
    /// Bandwidth: the largest distance between positions whose states act on each other.
    band: usize,
    /// Row, column (both as positions) and value of each nonzero.
    entries: Vec<(usize, usize, f64)>,
}

impl Ordered {
    /// Orders the states of a matrix of `count` rows, which has these nonzeros: row, column and value.
    pub fn of(count: usize, nonzeros: &[(usize, usize, f64)]) -> Self {
        let order = order(count, nonzeros);
        let mut places = vec![0; count];
        let positions = order.iter().enumerate();
        positions.for_each(|(place, &state)| places[state] = place);
        let entry = |&(row, column, value): &(usize, usize, f64)| (places[row], places[column], value);
        let entries: Vec<_> = nonzeros.iter().map(entry).collect();
        let distances = entries.iter().map(|(row, column, _)| row.abs_diff(*column));
        Self {
            order,
            band: distances.max().unwrap_or(0),
            entries,
        }
    }

    /// Orders the states of a dense square matrix.
    #[cfg(test)]
    pub fn of_dense(matrix: &DMatrix<f64>) -> Self {
        let entries = matrix.iter().enumerate();
        let entries = entries.map(|(at, value)| (at % matrix.nrows(), at / matrix.nrows(), *value));
        let nonzeros: Vec<_> = entries.filter(|entry| entry.2 != 0.0).collect();
        Self::of(matrix.nrows(), &nonzeros)
    }

    /// The matrix itself, with its states in their own order.
    pub fn dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::zeros(self.order.len(), self.order.len());
        for &(row, column, value) in &self.entries {
            dense[(self.order[row], self.order[column])] = value;
        }
        dense
    }

    /// The transpose, with the states in the same order.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let entries = self.entries.iter().map(|&(row, column, value)| (column, row, value));
        Self {
            order: self.order.clone(),
            band: self.band,
            entries: entries.collect(),
        }
    }

    /// True if no nonzero is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        self.entries.iter().all(|(_, _, value)| value.is_finite())
    }

    /// The product with a vector, both in the order of the positions.
    pub fn times(&self, vector: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let mut product = DVector::zeros(vector.len());
        for &(row, column, value) in &self.entries {
            product[row] += vector[column] * value;
        }
        product
    }

    /// The state at each position.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// The factors of the matrix less `shift` on its diagonal. A pivot that is zero becomes tiny.
    pub fn less(&self, shift: Complex<f64>) -> Factors {
        let (count, band) = (self.order.len(), self.band);
        let mut rows = Banded::zero(count, band);
        for &(row, column, value) in &self.entries {
            *rows.entry_mut(row, column) = value.into();
        }
        (0..count).for_each(|place| *rows.entry_mut(place, place) -= shift);
        Factors::of(rows, band)
    }

    /// The solution for a right-hand side whose entries are those of the states: of the matrix less `shift` on its
    /// diagonal.
    pub fn solution(&self, shift: Complex<f64>, right: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let mut vector: Vec<_> = self.order.iter().map(|&state| right[state]).collect();
        self.less(shift).solve(&mut vector);
        self.by_state(&vector)
    }

    /// A vector in the order of the states, of one in the order of the positions.
    pub fn by_state(&self, vector: &[Complex<f64>]) -> DVector<Complex<f64>> {
        let mut own = DVector::zeros(vector.len());
        let positions = self.order.iter().zip(vector);
        positions.for_each(|(&state, value)| own[state] = *value);
        own
    }
}

/// The states in the order of Cuthill and McKee.
fn order(count: usize, nonzeros: &[(usize, usize, f64)]) -> Vec<usize> {
    let mut neighbours = vec![Vec::new(); count];
    for &(one, other, _) in nonzeros.iter().filter(|(one, other, _)| one != other) {
        neighbours[one].push(other);
        neighbours[other].push(one);
    }
    for own in &mut neighbours {
        own.sort_unstable();
        own.dedup();
    }
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
pub(crate) struct Factors {
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
        let largest = rows.entries.iter().map(|entry| entry.norm_sqr()).fold(0.0, f64::max);
        let least = f64::EPSILON * largest.sqrt();
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
                if rows.entry(row, step) == Complex::ZERO {
                    continue;
                }
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

    /// The logarithm of the determinant; its imaginary part is known up to multiples of 2π.
    pub fn log_determinant(&self) -> Complex<f64> {
        let exchanges = self.exchanged.iter().enumerate().filter(|(step, pivot)| step != *pivot);
        let sign = if exchanges.count() % 2 == 0 { 1.0 } else { -1.0 };
        let (mut product, mut logarithm) = (Complex::from(sign), Complex::<f64>::ZERO);
        for step in 0..self.count {
            product *= self.rows.entry(step, step);
            // One logarithm for several pivots, whose product neither overflows nor vanishes.
            if !(1e-100..1e100).contains(&product.norm_sqr()) {
                logarithm += product.ln();
                product = Complex::ONE;
            }
        }
        logarithm + product.ln()
    }

    /// Replaces a right-hand side, in the order of the positions, by its solution.
    pub fn solve(&self, vector: &mut [Complex<f64>]) {
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
    use nalgebra::{Complex, DMatrix, DVector};

    use super::Ordered;

    /// A full matrix, and two chains that do not act on each other with their states mixed.
    #[test]
    fn solution_and_determinant_are_those_of_the_dense_matrix() {
        let entry = |row: usize, column: usize| ((7 * row + 3 * column * column + 1) as f64).sin();
        let full = DMatrix::from_fn(24, 24, entry);
        let chains = DMatrix::from_fn(24, 24, |row, column| {
            let [row, column] = [row, column].map(|state| 5 * state % 24);
            if row % 2 == column % 2 && row.abs_diff(column) <= 2 {
                entry(row, column)
            } else {
                0.0
            }
        });
        let shift = Complex::new(0.3, 0.7);
        let right = DVector::from_fn(24, |row, _| Complex::new(row as f64, 1.0));
        for matrix in [full, chains] {
            let dense = matrix.map(Complex::from) - DMatrix::from_diagonal_element(24, 24, shift);
            let (ordered, factors) = (Ordered::of_dense(&matrix), dense.lu());
            let exact = factors.solve(&right).expect("it is regular");
            let found = ordered.solution(shift, &right);
            assert!((&found - &exact).norm() < 1e-11 * exact.norm(), "{found} {exact}");
            let [found, exact] = [ordered.less(shift).log_determinant().exp(), factors.determinant()];
            assert!((found - exact).norm() < 1e-11 * exact.norm(), "{found} {exact}");
            assert_eq!(ordered.dense(), matrix);
        }
    }

    /// However its states are numbered, so that the work of an elimination grows with its length.
    #[test]
    fn a_chain_is_a_band_of_one() {
        let places: Vec<usize> = (0..80).map(|state| 37 * state % 80).collect();
        let links = places.windows(2).map(|ends| (ends[0], ends[1], 1.0));
        assert_eq!(Ordered::of(80, &links.collect::<Vec<_>>()).band, 1);
    }
}
