//! `JᵀJ`, `Jᵀr` and the scale of each variable.

use nalgebra::{DMatrix, DVector};

/// Rows of the Jacobian that are taken at once: twenty columns of them stay in a first-level cache.
const BLOCK: usize = 192;

/// The normal equations of a linearised problem.
pub(super) struct NormalEquations {
    /// `JᵀJ`.
    pub matrix: DMatrix<f64>,
    /// `Jᵀr`.
    pub gradient: DVector<f64>,
    /// The largest norm that each column ever had.
    pub largest: DVector<f64>,
    /// One over it; 1 for a column that was always zero.
    pub scale: DVector<f64>,
}

impl NormalEquations {
    pub fn new(variables: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(variables, variables),
            gradient: DVector::zeros(variables),
            largest: DVector::zeros(variables),
            scale: DVector::repeat(variables, 1.0),
        }
    }

    /// Takes a new linearisation; false where it holds a value that is not finite.
    pub fn assemble(&mut self, jacobian: &DMatrix<f64>, residual: &DVector<f64>) -> bool {
        self.matrix.fill(0.0);
        self.gradient.fill(0.0);
        let rows = residual.len();
        for from in (0..rows).step_by(BLOCK) {
            self.add_rows(
                jacobian.as_slice(),
                residual.as_slice(),
                rows,
                from..rows.min(from + BLOCK),
            );
        }
        self.matrix.fill_upper_triangle_with_lower_triangle();
        self.rescale();
        self.gradient
            .iter()
            .chain(self.matrix.iter())
            .all(|value| value.is_finite())
    }

    fn add_rows(&mut self, jacobian: &[f64], residual: &[f64], rows: usize, range: std::ops::Range<usize>) {
        let column = |k: usize| &jacobian[k * rows + range.start..k * rows + range.end];
        for i in 0..self.gradient.len() {
            self.gradient[i] += dot(column(i), &residual[range.clone()]);
            for j in 0..=i {
                self.matrix[(i, j)] += dot(column(i), column(j));
            }
        }
    }

    fn rescale(&mut self) {
        for k in 0..self.scale.len() {
            self.largest[k] = self.largest[k].max(self.matrix[(k, k)].sqrt());
            if self.largest[k] > 0.0 {
                self.scale[k] = 1.0 / self.largest[k];
            }
        }
    }
}

/// A dot product with eight independent sums, since one sum cannot be vectorised without reordering it.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a_chunks, b_chunks) = (a.chunks_exact(8), b.chunks_exact(8));
    let tail: f64 = a_chunks
        .remainder()
        .iter()
        .zip(b_chunks.remainder())
        .map(|(a, b)| a * b)
        .sum();
    let mut sums = [0.0; 8];
    for (a, b) in a_chunks.zip(b_chunks) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + tail
}
