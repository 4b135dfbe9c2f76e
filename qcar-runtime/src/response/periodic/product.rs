//! Products of small matrices.

use nalgebra::DMatrix;

use crate::vectors::{Loops, widest};

/// So few columns are multiplied one by one: the general method, which copies both matrices first, takes longer.
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
    if !one.is_empty() {
        widest(Product {
            rows: one.nrows(),
            one: one.as_slice(),
            columns: other.as_slice().chunks_exact(other.nrows()),
            into: product.as_mut_slice(),
        });
    }
    product
}

struct Product<'a> {
    rows: usize,
    one: &'a [f64],
    columns: std::slice::ChunksExact<'a, f64>,
    into: &'a mut [f64],
}

impl Loops for Product<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        for (into, factors) in self.into.chunks_exact_mut(self.rows).zip(self.columns) {
            for (column, factor) in self.one.chunks_exact(self.rows).zip(factors) {
                for (sum, value) in into.iter_mut().zip(column) {
                    *sum += factor * value;
                }
            }
        }
    }
}
