//! Information of the Jacobian at the optimum about the parameters: covariance, correlation, and undetermined
//! directions.

use nalgebra::{DMatrix, DVector};

use super::normal::products;

/// Singular values of the scaled Jacobian below this share of the largest count as zero: no measurement has the seven
/// digits that such a direction would need.
const RANK_TOLERANCE: f64 = 1e-7;

/// Largest trace of the inverse of the scaled normal equations for which ten digits of it are accurate. Every singular
/// value of the scaled Jacobian is then above `1e-3`, far above the tolerance of the rank, since its reciprocal square
/// is an eigenvalue of that inverse.
const LARGEST_TRACE: f64 = 1e6;

/// Smallest component of a variable in an undetermined direction for which it takes part.
const TAKES_PART: f64 = 1e-3;

/// Reason why a variable has no standard error.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Unseen {
    /// No residual depends on it.
    Nowhere,
    /// The residuals depend on it only in combination with others.
    Combination {
        /// Positions of the others.
        with: Vec<usize>,
    },
}

/// The linearised problem at its optimum, for the variables inside their bounds.
pub struct Information {
    /// Positions of the variables that are determined individually.
    seen: Vec<usize>,
    /// Reason for each other variable.
    unseen: Vec<Option<Unseen>>,
    /// `(JᵀJ)⁻¹` of the seen variables.
    inverse: DMatrix<f64>,
}

impl Information {
    /// Decomposes `jacobian`; variables outside `free` are fixed.
    ///
    /// Columns are scaled to unit length. If their normal equations are badly conditioned, they are reduced by QR, and
    /// the rank is that of the singular values of R.
    pub fn new(jacobian: &DMatrix<f64>, free: &[bool]) -> Self {
        let mut unseen: Vec<Option<Unseen>> = vec![None; free.len()];
        let mut columns: Vec<usize> = (0..free.len()).filter(|&k| free[k]).collect();
        columns.retain(|&k| {
            let seen = jacobian.column(k).norm() > 0.0;
            if !seen {
                unseen[k] = Some(Unseen::Nowhere);
            }
            seen
        });
        if let Some(inverse) = well_determined(jacobian, &columns) {
            return Self {
                seen: columns,
                unseen,
                inverse,
            };
        }
        let directions = Directions::new(jacobian, &columns);
        for (k, with) in directions.combinations(&columns) {
            unseen[k] = Some(Unseen::Combination { with });
        }
        let seen: Vec<usize> = columns.iter().copied().filter(|&k| unseen[k].is_none()).collect();
        let inverse = directions.inverse(&columns, &seen);
        Self { seen, unseen, inverse }
    }

    /// Why a variable has no standard error; `None` if it has one or is fixed.
    pub fn unseen(&self, variable: usize) -> Option<&Unseen> {
        self.unseen[variable].as_ref()
    }

    /// Positions of the variables with a standard error, in the order of the matrices and vectors below.
    pub fn seen(&self) -> &[usize] {
        &self.seen
    }

    /// `(JᵀJ)⁻¹`: the covariance for independent residuals of unit variance.
    pub fn inverse(&self) -> &DMatrix<f64> {
        &self.inverse
    }

    /// Change of the optimum, to first order, if the residual changes by `pattern`: `-(JᵀJ)⁻¹ Jᵀ pattern`.
    pub fn shift(&self, jacobian: &DMatrix<f64>, pattern: &DVector<f64>) -> DVector<f64> {
        -(&self.inverse * self.project(jacobian, pattern))
    }

    /// `Jᵀ pattern` of the seen variables.
    fn project(&self, jacobian: &DMatrix<f64>, pattern: &DVector<f64>) -> DVector<f64> {
        DVector::from_iterator(
            self.seen.len(),
            self.seen.iter().map(|&k| jacobian.column(k).dot(pattern)),
        )
    }
}

/// Correlation of a covariance matrix.
pub fn correlation(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let deviation = covariance.diagonal().map(f64::sqrt);
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        covariance[(i, j)] / (deviation[i] * deviation[j])
    })
}

/// `(JᵀJ)⁻¹` of these columns by a Cholesky factor, which is much cheaper than singular values; `None` if a direction
/// may be undetermined or digits would be lost.
fn well_determined(jacobian: &DMatrix<f64>, columns: &[usize]) -> Option<DMatrix<f64>> {
    let columns: Vec<&[f64]> = columns.iter().map(|&k| jacobian.column(k).data.into_slice()).collect();
    let products = products(&columns);
    let scale = products.diagonal().map(|square| square.sqrt().recip());
    let scaled = DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
        scale[i] * products[(i, j)] * scale[j]
    });
    let inverse = scaled.cholesky()?.inverse();
    let is_well_determined = inverse.trace() < LARGEST_TRACE;
    is_well_determined.then(|| {
        DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
            scale[i] * inverse[(i, j)] * scale[j]
        })
    })
}

/// The singular directions of the scaled Jacobian.
struct Directions {
    norms: Vec<f64>,
    /// Row by row, the directions in variable space.
    vectors: DMatrix<f64>,
    values: Vec<f64>,
    tolerance: f64,
}

impl Directions {
    fn new(jacobian: &DMatrix<f64>, columns: &[usize]) -> Self {
        let norms: Vec<f64> = columns.iter().map(|&k| jacobian.column(k).norm()).collect();
        if columns.is_empty() {
            return Self {
                norms,
                vectors: DMatrix::zeros(0, 0),
                values: Vec::new(),
                tolerance: 0.0,
            };
        }
        // Rows of zeros make a short problem square, so that the directions span all variables.
        let rows = jacobian.nrows().max(columns.len());
        let mut scaled = DMatrix::zeros(rows, columns.len());
        for (place, &k) in columns.iter().enumerate() {
            scaled
                .view_mut((0, place), (jacobian.nrows(), 1))
                .copy_from(&(jacobian.column(k) / norms[place]));
        }
        let decomposition = scaled.qr().r().svd(false, true);
        let values: Vec<f64> = decomposition.singular_values.iter().copied().collect();
        let tolerance = RANK_TOLERANCE * values.iter().copied().fold(0.0, f64::max);
        let vectors = decomposition.v_t.expect("the right singular vectors were asked for");
        Self {
            norms,
            vectors,
            values,
            tolerance,
        }
    }

    fn null(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.values.len()).filter(|&d| self.values[d] <= self.tolerance)
    }

    /// The variables of each undetermined direction, each with the others that take part.
    fn combinations(&self, columns: &[usize]) -> Vec<(usize, Vec<usize>)> {
        let takes_part = |d: usize, place: usize| self.vectors[(d, place)].abs() >= TAKES_PART;
        let partners = |place: usize| -> Vec<usize> {
            let shares = |other: usize| self.null().any(|d| takes_part(d, place) && takes_part(d, other));
            (0..columns.len())
                .filter(|&other| other != place && shares(other))
                .map(|other| columns[other])
                .collect()
        };
        let unseen = (0..columns.len()).filter(|&place| self.null().any(|d| takes_part(d, place)));
        unseen.map(|place| (columns[place], partners(place))).collect()
    }

    /// `(JᵀJ)⁻¹` over the determined directions, for the rows and columns of `seen`.
    fn inverse(&self, columns: &[usize], seen: &[usize]) -> DMatrix<f64> {
        let places: Vec<usize> = (0..columns.len())
            .filter(|&place| seen.contains(&columns[place]))
            .collect();
        DMatrix::from_fn(seen.len(), seen.len(), |i, j| {
            let (i, j) = (places[i], places[j]);
            let sum: f64 = (0..self.values.len())
                .filter(|&d| self.values[d] > self.tolerance)
                .map(|d| self.vectors[(d, i)] * self.vectors[(d, j)] / (self.values[d] * self.values[d]))
                .sum();
            sum / (self.norms[i] * self.norms[j])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_is_seen_only_in_combination_and_a_missing_column_nowhere() {
        let jacobian = DMatrix::from_row_slice(3, 4, &[1.0, 1.0, 0.0, 2.0, 2.0, 2.0, 0.0, 1.0, 3.0, 3.0, 0.0, -1.0]);
        let information = Information::new(&jacobian, &[true; 4]);
        assert_eq!(information.unseen(0), Some(&Unseen::Combination { with: vec![1] }));
        assert_eq!(information.unseen(1), Some(&Unseen::Combination { with: vec![0] }));
        assert_eq!(information.unseen(2), Some(&Unseen::Nowhere));
        assert_eq!(information.seen(), [3]);
    }

    #[test]
    fn the_inverse_is_that_of_the_normal_equations() {
        let jacobian = DMatrix::from_row_slice(4, 2, &[1.0, 2e3, 0.5, -1e3, 3.0, 4e3, 0.1, 1e3]);
        let direct = (jacobian.transpose() * &jacobian).try_inverse().unwrap();
        let information = Information::new(&jacobian, &[true; 2]);
        assert!((information.inverse() - &direct).norm() < 1e-12 * direct.norm());
    }

    /// By Cholesky's factor and by singular values: the inverse of two columns at a small angle is known in closed
    /// form.
    #[test]
    fn columns_that_are_nearly_parallel_keep_nine_digits() {
        for angle in [1e-2, 1e-4] {
            let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, 1.0, 0.0, angle, 0.0, 0.0]);
            let square = 1.0 / (angle * angle);
            let direct = DMatrix::from_row_slice(2, 2, &[1.0 + square, -square, -square, square]);
            let information = Information::new(&jacobian, &[true; 2]);
            let error = (information.inverse() - &direct).norm() / direct.norm();
            assert!(error < 1e-9, "{error} at {angle}");
        }
    }

    #[test]
    fn a_held_variable_takes_no_share_of_the_uncertainty() {
        let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, 0.9, 1.0, 1.1, 1.0, 1.0]);
        let information = Information::new(&jacobian, &[true, false]);
        assert_eq!(information.seen(), [0]);
        assert!((information.inverse()[(0, 0)] - 1.0 / 3.0).abs() < 1e-12);
    }
}
