//! Products of small matrices.

use nalgebra::DMatrix;

use crate::vectors::{Loops, widest};

/// Largest number of columns that are multiplied one by one; the general method copies both matrices first, which takes
/// longer.
const FEW: usize = 4;

/// The product of two matrices.
pub fn product(one: &DMatrix<f64>, other: &DMatrix<f64>) -> DMatrix<f64> {
    assert_eq!(
        one.ncols(),
        other.nrows(),
        "columns of one matrix and rows of the other"
    );
    if other.ncols() > FEW {
        return one * other;
    }
    let mut product = DMatrix::zeros(one.nrows(), other.ncols());
    for (mut into, factors) in product.column_iter_mut().zip(other.column_iter()) {
        add(one.as_slice(), factors.as_slice(), into.as_mut_slice());
    }
    product
}

/// Adds the columns of a matrix, each with its factor.
pub fn add(columns: &[f64], factors: &[f64], into: &mut [f64]) {
    if !into.is_empty() {
        widest(Sum { columns, factors, into });
    }
}

struct Sum<'a> {
    columns: &'a [f64],
    factors: &'a [f64],
    into: &'a mut [f64],
}

impl Loops for Sum<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        for (column, factor) in self.columns.chunks_exact(self.into.len()).zip(self.factors) {
            for (sum, value) in self.into.iter_mut().zip(column) {
                *sum += factor * value;
            }
        }
    }
}
